"""The steps of a study, and how far each trainee has come."""
