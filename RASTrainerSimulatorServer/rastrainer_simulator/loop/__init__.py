"""The control loop, which owns time."""
