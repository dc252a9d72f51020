"""The drill of decisions: whether to proceed with a registration; its record and its score."""
