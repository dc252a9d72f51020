"""Cohorts of virtual trainees with known skills, to plan studies and to test every statistic."""
