"""Gamepads at the simulator, read through SDL."""
