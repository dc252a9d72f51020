"""Scripted trainees, and cohorts of them."""
