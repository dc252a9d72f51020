"""The record of trials: writing journals, and delivering trials."""
