"""Turns the operator's input into the target of the tool's tip."""
