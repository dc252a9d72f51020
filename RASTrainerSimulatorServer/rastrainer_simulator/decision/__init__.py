"""The drill of decisions: cases of finished registrations, sound or with a fault."""
