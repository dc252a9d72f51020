"""Procedures: planned trajectories into a head, what was done along them, errors and score."""
