"""How trainees get better: learning curves, control charts, pass marks."""
