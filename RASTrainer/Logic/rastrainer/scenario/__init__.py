"""What is trained on: a scenario, its points, its set-up, its folder and the library."""
