"""Procedures: planned trajectories into a head, their records, errors and score."""
