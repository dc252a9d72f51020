"""Commands for files: each module has `add_parser`, and its `run` returns the exit status."""
