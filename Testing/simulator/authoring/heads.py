"""Heads for which tasks are proposed: one made of formulas, a real one, and a deformed one."""

import numpy as np

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer_simulator.assets import asset_path
from Testing.domain.head.spheres import sphere_mesh


def egg():
    """A head of an egg's shape with a nose, cut flat."""
    sphere = sphere_mesh(4)
    direction = sphere.vertices / 90.0
    nose = np.array([0.0, 0.87, -0.5])
    bump = 18.0 * np.exp(-((np.linalg.norm(direction - nose, axis=1) / 0.15) ** 2))
    vertices = direction * np.array([78.0, 98.0, 100.0]) + direction * bump[:, None]
    vertices[:, 2] = np.maximum(vertices[:, 2], -75.0)
    return HeadMesh(vertices, sphere.triangles)


def colin27():
    """The head that comes with RASTrainer."""
    return read_head_mesh(asset_path("scenarios", "colin27", "head.ply"))


def deformed():
    """The same, but longer, narrower, and wider at the back than at the front."""
    mesh = colin27()
    vertices = mesh.vertices.astype(float) * [0.94, 1.04, 0.98]
    back = (vertices[:, 1].max() - vertices[:, 1]) / np.ptp(vertices[:, 1])
    vertices[:, 0] *= 0.97 + 0.06 * back
    return HeadMesh(vertices.astype(np.float32), mesh.triangles)


def small():
    """The deformed head as a child's: a seventh narrower and shorter, and flatter."""
    mesh = deformed()
    vertices = mesh.vertices.astype(float) * [0.86, 0.84, 0.88]
    return HeadMesh(vertices.astype(np.float32), mesh.triangles)


HEADS = {"egg": egg, "colin27": colin27, "deformed": deformed}
