"""A scenario to train on: its points, its set-up, its folder and the library."""
