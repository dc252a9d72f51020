"""Paired-point registration: fits, checks, faults, and expected and true target error."""
