"""Viewpoints of the picture: the view that the trainee moves, and the best for a touch."""
