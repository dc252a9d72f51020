"""Measure how far our iiwa 7 is from its official shape, in both directions.

    python -m Testing.simulator.robot.compare_meshes --official FOLDER [--samples N]

FOLDER holds link_0.stl … link_7.stl, in meters, all in the base frame at q = 0 (or a folder
`collision` with them). Points are drawn evenly over each robot's surface at q = 0 and kept where
they can be seen from outside: not on the ground, and with at least one in twenty of the directions
over the point open. The distance from each of these to the nearest point of the other robot is
taken. The tool is left out: it is ours.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import trimesh

from rastrainer.transforms import MM_PER_M
from Testing.sphere_directions import sphere_directions

sys.path.insert(0, str(Path(__file__).parents[3] / "assets" / "robots"))
from iiwa7_dimensions import JOINTS, LINK_NAMES
from make_iiwa7 import visual_parts

DIRECTIONS = 128
OPEN_FRACTION = 0.05
LIFT = 1e-4
GROUND = 0.001


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--official", type=Path, required=True)
    parser.add_argument("--samples", type=int, default=20_000)
    arguments = parser.parse_args()
    folder = arguments.official
    if (folder / "collision").is_dir():
        folder = folder / "collision"
    # Links 0 to 7 as they look, at q = 0, in the base frame, in meters.
    parts = visual_parts()
    origins = np.cumsum([(0.0, 0.0, 0.0), *(joint.origin for joint in JOINTS)], axis=0)
    ours = [
        trimesh.util.concatenate(list(parts[name].values())).apply_translation(origin)
        for name, origin in zip(LINK_NAMES, origins, strict=False)
    ]
    official = [trimesh.load_mesh(folder / f"link_{number}.stl") for number in range(8)]
    for title, one, other in (
        ("ours to official", ours, official),
        ("official to ours", official, ours),
    ):
        distances, links = surface_distances(one, other, arguments.samples)
        print(f"{title}: {_summary(distances)}")
        for link, name in enumerate(LINK_NAMES[:8]):
            print(f"  {name}: {_summary(distances[links == link])}")


def surface_distances(
    one: list[trimesh.Trimesh], other: list[trimesh.Trimesh], samples: int, seed: int = 7
) -> tuple[np.ndarray, np.ndarray]:
    """Return how far the visible surface of `one` is from `other`, and each point's link.

    Distances (n,) float in mm; link numbers (n,) int.
    """
    whole, target = trimesh.util.concatenate(one), trimesh.util.concatenate(other)
    points, faces = trimesh.sample.sample_surface(whole, samples, seed=seed)
    links = np.repeat(np.arange(len(one)), [len(mesh.faces) for mesh in one])[faces]
    # Seen are points that see the outside in enough of the directions above them.
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
