"""The steps of a study, and the progress of each trainee."""
