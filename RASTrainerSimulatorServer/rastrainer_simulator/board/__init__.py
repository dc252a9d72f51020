"""A teacher's board: live tiles of several simulators."""
