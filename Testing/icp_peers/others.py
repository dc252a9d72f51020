"""ICP by Open3D and small_gicp: run by the Python of `.venv/icp`, which has nothing else.

    python others.py CASES.npz RESULTS.npz

CASES.npz holds `vertices` and `triangles` of a head's skin, and `traces` (k, n, 3) float, mm, as
their starts place them. RESULTS.npz gets `open3d` and `small_gicp`, (k, 4, 4) float: how each moves
the traces. Neither knows triangles: both get points all over them, and go from point to plane.
"""

import sys

import numpy as np
import open3d
import small_gicp

SPACING_MM = 1.0
"""Spacing of the points on the skin."""
REACH_MM = 60.0
"""No point of a trace is this far off."""
STEPS = 500


def dense(vertices, triangles):
    """Return points (m, 3) on the triangles, no farther than SPACING_MM apart, and normals."""
    corners = vertices[triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    parts = np.ceil(sides / SPACING_MM).astype(int)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    points, along = [], []
    for count in np.unique(parts):
        own = parts == count
        # Centers of the parts: places on sides would be there twice, and have no one normal.
        v, w = np.meshgrid(np.arange(count), np.arange(count), indexing="ij")
        inside, upper = v + w < count, v + w < count - 1
        v, w = (np.concatenate([x[inside] + 1 / 3, x[upper] + 2 / 3]) / count for x in (v, w))
        shares = np.stack([1.0 - v - w, v, w], axis=1)
        points.append(np.einsum("kj,tji->tki", shares, corners[own]).reshape(-1, 3))
        along.append(np.repeat(normals[own], len(shares), axis=0))
    return np.vstack(points), np.vstack(along)


def by_open3d(points, normals, traces):
    """Return how Open3D moves each trace."""
    target = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
    target.normals = open3d.utility.Vector3dVector(normals)
    registration = open3d.pipelines.registration
    to_plane = registration.TransformationEstimationPointToPlane()
    criteria = registration.ICPConvergenceCriteria(1e-12, 1e-12, STEPS)
    found = []
    for trace in traces:
        source = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(trace))
        result = registration.registration_icp(
            source, target, REACH_MM, np.eye(4), to_plane, criteria
        )
        found.append(result.transformation)
    return np.array(found)


def by_small_gicp(points, traces):
    """Return how small_gicp moves each trace; it takes its normals from the points."""
    target = small_gicp.PointCloud(points)
    tree = small_gicp.KdTree(target)
    small_gicp.estimate_normals_covariances(target, tree, 12)
    found = []
    for trace in traces:
        result = small_gicp.align(
            target,
            small_gicp.PointCloud(trace),
            tree,
            registration_type="PLANE_ICP",
            max_correspondence_distance=REACH_MM,
            max_iterations=STEPS,
            rotation_epsilon=1e-8,
            translation_epsilon=1e-6,
        )
        found.append(result.T_target_source)
    return np.array(found)


if __name__ == "__main__":
    with np.load(sys.argv[1]) as given:
        skin, normals_ = dense(given["vertices"], given["triangles"])
        moved = given["traces"]
    np.savez(
        sys.argv[2],
        open3d=by_open3d(skin, normals_, moved),
        small_gicp=by_small_gicp(skin, moved),
    )
