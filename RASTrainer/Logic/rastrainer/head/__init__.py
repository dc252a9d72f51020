"""A head: its mesh, surface paths, normals, pose, images, and the removal of its face."""
