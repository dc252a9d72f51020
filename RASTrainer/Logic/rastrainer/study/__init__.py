"""What is stored of all trainees, what it shows, and how it is exported."""
