"""What was stored of all trainees, and what it shows."""
