"""The environment and folder in which a child process runs."""
