"""Propose tasks for a head: where the robot can touch it, and in which order a trainee shall."""
