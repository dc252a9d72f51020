"""Landmarks of a head: proposed on it, read from a file, and checked.

A proposal carries the landmarks of Colin27's head to similar places of another head: the reference
head is turned, shifted and scaled along its three axes until it fits the other head (ICP; the worst
tenth of the points does not count). Then the skin around each landmark is moved as a rigid patch
until it fits the skin there, because the size of a head alone does not say where eyes, nose and
ears are. The user checks the result.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import scipy.spatial

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_files import read_markups, write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, outward_normals, read_head_mesh
from rastrainer.registration.fits import RIGID, fit
from rastrainer.scenario.points import (
    FACE_LANDMARKS,
    MAX_LANDMARKS,
    NOSE_TIP,
    Landmark,
    check_landmarks,
    on_skin,
    spread_first,
)
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.face_removal import nose_tip
from rastrainer_simulator.authoring.planning_setup import POSES_TRIED, PlanningSetup

REFERENCE = {
    "Nasion": (1.0, 84.4, -40.0),
    "Right outer canthus": (52.6, 62.0, -42.1),
    "Left outer canthus": (-51.5, 61.8, -43.2),
    "Right inner canthus": (13.6, 72.8, -41.1),
    "Left inner canthus": (-14.5, 70.4, -42.5),
    "Right tragus": (86.4, -22.8, -56.3),
    "Left tragus": (-86.9, -22.8, -56.3),
}
"""On the head of Colin27, RAS mm, found by eye on pictures of the mesh."""
POINTS, OTHER_POINTS, PATCH_POINTS = 800, 6000, 150
PATCH_MM, LEAST_PATCH = 30.0, 50
ROUNDS, PATCH_ROUNDS = 40, 20
ABOVE_BASE_MM = 10.0
"""Points of the reference lower than this are left out: heads end at different heights."""
COUNTED_SHARE = 0.9
SCALES = (0.7, 1.4)
PATCH_LIMIT_MM = 12.0
"""A patch that would move farther has found something else, and is not moved."""
NOSE_BELOW_MM = (25.0, 70.0)
"""How far below the nasion the tip of the nose is."""
NEAR_MM, PLACES_TRIED = 6.0, 8


def unreachable(planning: PlanningSetup, landmarks: Sequence[Landmark]) -> list[str]:
    """Return the names of landmarks that the robot cannot touch in some pose of a trial.

    It reaches one if it can touch a place within 6 mm of it: a landmark is not an exact point.
    """
    poses, mesh = planning.poses(range(POSES_TRIED)), planning.mesh
    found = []
    for landmark in landmarks:
        away = np.linalg.norm(mesh.vertices - landmark.position_ras, axis=1)
        around = mesh.vertices[_thinned(np.flatnonzero(away < NEAR_MM), PLACES_TRIED)]
        places = np.vstack([landmark.position_ras, around]).astype(float)
        each = [*zip(places[:, None], outward_normals(mesh, places)[:, None], strict=True)]
        if not all(any(planning.touchable(*one, [pose])[0] for one in each) for pose in poses):
            found.append(landmark.name)
    return found


def landmarks_on(mesh: HeadMesh) -> tuple[Landmark, ...]:
    """Return the reference's landmarks on another head, RAS mm, in the order of their names."""
    reference = read_head_mesh(asset_path("scenarios", "colin27") / "head.ply")
    onto = _whole(reference, mesh)
    places = {
        name: _local(reference, np.array(place), onto, mesh) for name, place in REFERENCE.items()
    }
    nose = nose_tip(mesh)
    below = places["Nasion"][2] - nose[2]
    if NOSE_BELOW_MM[0] < below < NOSE_BELOW_MM[1] and nose[1] > places["Nasion"][1]:
        places[NOSE_TIP] = np.asarray(nose, dtype=float)
    base = float(mesh.vertices[:, 2].min())
    return tuple(
        Landmark(name, nearest_on_mesh(mesh, places[name]).position.round(1))
        for name in FACE_LANDMARKS
        if name in places and places[name][2] > base
    )


def _whole(reference: HeadMesh, mesh: HeadMesh) -> np.ndarray:
    """Return the transform (4, 4) that fits the reference to the head: rigid after a scaling.

    Distances are measured along the normals of the other head (point to plane: Chen and Medioni
    1992), to its vertices, which are thinned out.
    """
    points = _thinned(np.flatnonzero(_is_skin(reference)), POINTS)
    points = reference.vertices[points].astype(float)
    others = _thinned(np.arange(len(mesh.vertices)), OTHER_POINTS)
    places, normals = mesh.vertices[others].astype(float), mesh.vertex_normals[others]
    is_skin, tree = _is_skin(mesh)[others], scipy.spatial.KDTree(places)
    # At first scaled and shifted to the same top, width and length.
    own, other = (
        np.array([each.vertices.min(axis=0), each.vertices.max(axis=0)])
        for each in (reference, mesh)
    )
    across = (other[1] - other[0]) / (own[1] - own[0])
    scales = np.clip(np.array([across[0], across[1], across[:2].mean()]), *SCALES)
    pose = np.eye(4)
    pose[:2, 3] = (other.mean(axis=0) - scales * own.mean(axis=0))[:2]
    pose[2, 3] = other[1, 2] - scales[2] * own[1, 2]
    for _ in range(ROUNDS):
        moved = transforms.apply(pose, points * scales)
        away, nearest = tree.query(moved)
        counts = is_skin[nearest]
        counts &= away <= np.quantile(away[counts], COUNTED_SHARE)
        normal, q, p = normals[nearest[counts]], moved[counts], points[counts]
        middle = q.mean(axis=0)
        along = (normal @ pose[:3, :3]) * p
        rows = np.hstack([np.cross(q - middle, normal), normal, along])
        off = np.einsum("ij,ij->i", normal, places[nearest[counts]] - q)
        step = np.linalg.lstsq(rows, off, rcond=1e-6)[0]
        turned = transforms.rotations(step[None, :3])[0]
        shift = middle + step[3:6] - turned @ middle
        pose = transforms.rigid(turned, shift) @ pose
        scales = np.clip(scales + step[6:], *SCALES)
    return pose @ np.diag([*scales, 1.0])


def _is_skin(mesh: HeadMesh) -> np.ndarray:
    """Return which vertices (n,) bool are skin: not near the base, where heads are cut off."""
    return mesh.vertices[:, 2] > mesh.vertices[:, 2].min() + ABOVE_BASE_MM


def _thinned(indices: np.ndarray, count: int) -> np.ndarray:
    return indices[:: max(len(indices) // count, 1)]


def _local(reference: HeadMesh, place: np.ndarray, onto: np.ndarray, mesh: HeadMesh) -> np.ndarray:
    """Return where the skin around a landmark puts it, (3,) RAS mm of the other head."""
    away = np.linalg.norm(reference.vertices - place, axis=1)
    patch = np.flatnonzero((away < PATCH_MM) & _is_skin(reference))
    patch = reference.vertices[_thinned(patch, PATCH_POINTS)].astype(float)
    start = transforms.apply(onto, np.vstack([place, patch]))
    away = np.linalg.norm(mesh.vertices - start[0], axis=1)
    others = mesh.vertices[(away < 2.0 * PATCH_MM) & _is_skin(mesh)].astype(float)
    if len(others) < LEAST_PATCH:
        return start[0]
    points, tree = start, scipy.spatial.KDTree(others)
    for _ in range(PATCH_ROUNDS):
        least, nearest = tree.query(points[1:])
        counts = least <= np.quantile(least, COUNTED_SHARE)
        step = fit(points[1:][counts], others[nearest[counts]], RIGID)
        points = transforms.apply(step, points)
    has_strayed = np.linalg.norm(points[0] - start[0]) > PATCH_LIMIT_MM
    return start[0] if has_strayed else points[0]


LONGEST_NAME = 40


def read_placed_landmarks(path: Path) -> tuple[Landmark, ...]:
    """Return the landmarks of a markups file, in its order."""
    placed = read_markups(path)
    labels = [label.strip() for label in placed.labels or [""] * len(placed.points)]
    if len(labels) > MAX_LANDMARKS:
        raise InputError(f"{path.name} has {len(labels)} landmarks, at most {MAX_LANDMARKS} fit.")
    for number, label in enumerate(labels, 1):
        if not 1 <= len(label) <= LONGEST_NAME or not label.isprintable():
            raise InputError(
                f"Landmark {number} needs a name of 1 to {LONGEST_NAME} characters, such as Nasion."
            )
    points = np.array(placed.points, dtype=float)
    return tuple(Landmark(label, place) for label, place in zip(labels, points, strict=True))


def check_on_planned_head(planning: PlanningSetup, landmarks: Sequence[Landmark]) -> list[str]:
    """Return a sentence for each fault of landmarks: their positions, or the reach."""
    wrong = check_landmarks(planning.mesh, landmarks)
    if wrong:
        return wrong
    return [
        f"The robot does not reach {name} in every pose of a trial; leave it out, or move the head."
        for name in unreachable(planning, on_skin(planning.mesh, landmarks))
    ]


def write_proposal(folder: Path, path: Path) -> list[str]:
    """Write landmarks for the head of a scenario to a markups file; return sentences about them."""
    scenario = load_scenario(folder)
    mesh = read_head_mesh(scenario.head)
    found = landmarks_on(mesh)
    unreached = unreachable(PlanningSetup(scenario, mesh), found)
    # In the order of touching, the three that a trace begins with first.
    kept = spread_first([each for each in found if each.name not in unreached])
    places = np.array([each.position_ras for each in kept], dtype=float).reshape(-1, 3)
    write_markups(path, PointList(tuple(each.name for each in kept), places))
    missing = [name for name in FACE_LANDMARKS if name not in {each.name for each in found}]
    out_of_reach = "is left out: the robot does not reach it in every pose of a trial."
    return [
        f"{len(kept)} landmarks are proposed: look at each, and move it where it is wrong.",
        *(f"{name} is not on the head, which ends above it." for name in missing),
        *(f"{name} {out_of_reach}" for name in unreached),
    ]
