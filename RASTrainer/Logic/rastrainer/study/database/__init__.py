"""The SQLite file that holds trainees, trials, scores and answers."""
