"""The panels over the picture, painted from what the simulator's screen says."""
