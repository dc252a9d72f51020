"""The desktop window: a view in its own process, which draws what the simulator sends."""
