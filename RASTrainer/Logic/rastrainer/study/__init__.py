"""The study: stored data of all trainees, their evaluation and their export."""
