"""Blinded rating of replays: forms, marks and who has marked what."""
