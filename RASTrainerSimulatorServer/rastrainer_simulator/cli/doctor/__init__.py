"""The checks of `rastrainer doctor`, by subject."""
