"""The tutorial: its steps, and a trainee's progress."""
