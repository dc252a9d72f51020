"""One trial: its record, analysis, truth, score and feedback."""
