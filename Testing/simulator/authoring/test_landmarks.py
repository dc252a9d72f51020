"""Landmarks are proposed on other heads, and checked with the robot's reach."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import HeadMesh
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.landmarks import REFERENCE, landmarks_on, read_placed_landmarks
from rastrainer_simulator.cli.main import main
from Testing.simulator.authoring.heads import colin27

COLIN27 = asset_path("scenarios", "colin27")
LARGEST_MM, USUAL_MM = 4.0, 2.0


def other_head(seed):
    """Return how another head differs from Colin27's: size, shape and position."""
    random = np.random.default_rng(seed)
    scales, angles = random.uniform(0.86, 1.12, 3), np.radians(random.uniform(-8, 8, 3))
    shift, waves = random.uniform(-20, 20, 3), random.normal(0.0, 0.02, (6, 3))
    sizes = random.normal(0.0, 1.0, (6, 3))
    turn = np.eye(3)
    for axis, angle in enumerate(angles):
        one, other = (axis + 1) % 3, (axis + 2) % 3
        step = np.eye(3)
        step[[one, other, one, other], [one, other, other, one]] = (
            *[np.cos(angle)] * 2,
            -np.sin(angle),
            np.sin(angle),
        )
        turn = step @ turn

    def moved(points):
        return (points + np.cos(points @ waves.T) @ sizes) * scales @ turn.T + shift

    return moved


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.soak) for seed in range(1, 12))]
)
def test_landmarks_are_proposed_where_another_head_has_them(seed):
    mesh, moved = colin27(), other_head(seed)
    head = HeadMesh(moved(mesh.vertices.astype(float)).astype(np.float32), mesh.triangles)
    found = {each.name: each.position_ras for each in landmarks_on(head)}
    assert set(REFERENCE) <= set(found)
    true = moved(np.array([*REFERENCE.values()]))
    away = [
        np.linalg.norm(found[name] - place) for name, place in zip(REFERENCE, true, strict=True)
    ]
    assert max(away) < LARGEST_MM
    assert np.mean(away) < USUAL_MM


@pytest.mark.soak
def test_only_landmarks_within_the_robots_reach_are_proposed_and_the_others_are_named(
    tmp_path, capsys
):
    path = tmp_path / "proposed.mrk.json"
    assert main(["scenario", "landmarks", str(COLIN27), str(path), "--propose"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("6 landmarks are proposed: look at each")
    assert "Right tragus is left out: the robot does not reach it" in said
    assert "Tip of the nose is not on the head" in said
    proposed = {each.name: each.position_ras for each in read_placed_landmarks(path)}
    own = {each.name: each.position_ras for each in load_scenario(COLIN27).landmarks}
    assert proposed.keys() == {*own, "Left outer canthus"}
    for name, place in own.items():
        assert np.linalg.norm(proposed[name] - place) < 1.0
    assert main(["scenario", "landmarks", str(COLIN27), str(path)]) == 0
    assert capsys.readouterr().out == "The landmarks can be used.\n"


def placed_file(path, **moved):
    """Write the default head's landmarks, some somewhere else, and return the file."""
    places = {each.name: each.position_ras for each in load_scenario(COLIN27).landmarks}
    places |= {name.replace("_", " "): np.array(place) for name, place in moved.items()}
    write_markups(path, PointList(tuple(places), np.array([*places.values()])))
    return path


def test_landmarks_out_of_reach_or_off_the_skin_are_refused_and_nothing_is_written(
    tmp_path, capsys
):
    path = placed_file(tmp_path / "own.mrk.json", Right_tragus=REFERENCE["Right tragus"])
    assert main(["scenario", "landmarks", str(COLIN27), str(path)]) == 1
    assert "The robot does not reach Right tragus in every pose" in capsys.readouterr().out
    path = placed_file(path, Nasion=(0.0, 120.0, -40.0))
    folder = tmp_path / "own"
    words = ["scenario", "plan", str(COLIN27), "--title", "Own", "-o", str(folder)]
    assert main([*words, "--landmarks", str(path)]) == 2
    assert "Nasion is " in capsys.readouterr().err
    assert not folder.exists()
