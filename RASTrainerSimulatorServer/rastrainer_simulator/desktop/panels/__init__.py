"""The panels over the picture, painted from the simulator's screen."""
