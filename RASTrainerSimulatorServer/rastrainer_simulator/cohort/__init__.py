"""Cohorts of virtual trainees who play real trials, on all cores."""
