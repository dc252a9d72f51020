"""A trial's journal as a file: its lines, and how they are read and checked."""
