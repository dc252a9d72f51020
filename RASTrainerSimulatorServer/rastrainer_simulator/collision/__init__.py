"""Collision and clearance: how near the arm is to the head, and where it has to stop."""
