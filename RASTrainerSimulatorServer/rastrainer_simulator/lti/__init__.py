"""Learning platforms: launches from a course, and grades returned to it (LTI 1.3)."""
