"""Groups of trainees who perform alike, or the reason why none are told."""
