"""Cohorts of virtual trainees whose parameters are set, to plan studies and test statistics."""
