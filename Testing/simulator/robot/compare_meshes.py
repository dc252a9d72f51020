"""Measure how far our iiwa 7 is from its official shape, in both directions.

    python -m Testing.simulator.robot.compare_meshes --official FOLDER [--samples N]

FOLDER holds link_0.stl … link_7.stl, as of `--robot-meshes`. Points are drawn evenly over each
robot's surface at q = 0 and kept where they can be seen from outside: not on the ground, and with
at least one in twenty of the directions over the point open. The distance from each of these to the
nearest point of the other robot is taken. The tool is left out: it is ours.
"""

import argparse
from pathlib import Path

import numpy as np
import trimesh

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import load_robot
from Testing.sphere_directions import sphere_directions

DIRECTIONS = 128
OPEN_FRACTION = 0.05
LIFT = 1e-4
GROUND = 0.001


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--official", type=Path, required=True)
    parser.add_argument("--samples", type=int, default=20_000)
    arguments = parser.parse_args()
    ours, official = outstretched(None), outstretched(arguments.official)
    for title, one, other in (
        ("ours to official", ours, official),
        ("official to ours", official, ours),
    ):
        distances, links = surface_distances(one, other, arguments.samples)
        print(f"{title}: {_summary(distances)}")
        for link in range(len(one)):
            print(f"  link {link}: {_summary(distances[links == link])}")


def outstretched(mesh_folder: Path | None) -> list[trimesh.Trimesh]:
    """Return links 0 to 7 as they look, at q = 0, in the base frame, m."""
    robot = load_robot(mesh_folder=mesh_folder)
    poses, meshes = make_kinematics(robot).links((0.0,) * 7), load_meshes(robot)
    names = [link.name for link in robot.moving_links]
    return [
        trimesh.util.concatenate([mesh for mesh, _color in meshes[name]]).apply_transform(
            poses[name]
        )
        for name in names
    ]


def surface_distances(
    one: list[trimesh.Trimesh], other: list[trimesh.Trimesh], samples: int, seed: int = 7
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the visible surface of `one` is from `other`, mm, and each point's link."""
    whole, target = trimesh.util.concatenate(one), trimesh.util.concatenate(other)
    points, faces = trimesh.sample.sample_surface(whole, samples, seed=seed)
    links = np.repeat(np.arange(len(one)), [len(mesh.faces) for mesh in one])[faces]
    normals = whole.face_normals[faces]
    above, free = np.zeros(len(points)), np.zeros(len(points))
    for direction in sphere_directions(DIRECTIONS):
        facing = np.flatnonzero(normals @ direction > 0)
        starts = points[facing] + LIFT * normals[facing]
        hit = whole.ray.intersects_any(starts, np.tile(direction, (len(facing), 1)))
        above[facing] += 1
        free[facing[~hit]] += 1
    seen = (free >= OPEN_FRACTION * above) & (points[:, 2] > GROUND)
    _, distances, _ = trimesh.proximity.closest_point(target, points[seen])
    return distances * MM_PER_M, links[seen]


def _summary(distances: np.ndarray) -> str:
    high, largest = np.percentile(distances, 95), distances.max()
    return f"mean {distances.mean():.2f} mm, 95 % below {high:.2f} mm, largest {largest:.1f} mm"


if __name__ == "__main__":
    main()
