"""Curricula: what trainees should reach, in which order, and the progress of each."""
