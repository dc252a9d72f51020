"""Gamepads, keyboards and views: bindings, and the controls that they move."""
