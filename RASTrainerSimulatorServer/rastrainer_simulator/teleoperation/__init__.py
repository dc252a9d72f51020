"""From the operator's hands to where the tool's tip shall be."""
