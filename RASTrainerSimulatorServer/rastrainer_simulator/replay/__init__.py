"""Playing a recorded trial again."""
