"""Curricula: what trainees are to reach, in which order, and how far each has come."""
