"""A head: its mesh, surface, pose and images."""
