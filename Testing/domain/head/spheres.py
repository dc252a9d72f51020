"""Head-sized spheres whose geometry is known exactly."""

import numpy as np
import trimesh

from rastrainer.head.mesh import HeadMesh

RADIUS_MM = 90.0


def sphere_mesh(subdivisions=4):
    sphere = trimesh.creation.icosphere(subdivisions, RADIUS_MM)
    return HeadMesh(np.array(sphere.vertices), np.array(sphere.faces))


def on_sphere(longitude_deg, latitude_deg):
    """A point at the sphere's radius; latitude 90 is its top (S), longitude 90 its front (A)."""
    longitude, latitude = np.radians(longitude_deg), np.radians(latitude_deg)
    level = np.cos(latitude)
    return RADIUS_MM * np.array(
        [level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)]
    )
