"""What was stored of all trainees, what it shows, and as what it is given to others."""
