"""A trial's journal as a file: its lines, how they are read and checked, what they say."""
