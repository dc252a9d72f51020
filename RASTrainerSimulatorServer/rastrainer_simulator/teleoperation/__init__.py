"""From the operator's input to the target of the tool's tip."""
