"""Blinded rating: a rater watches replays under numbers, and marks each on forms."""
