"""Pictures of the scene by VTK, off screen."""
