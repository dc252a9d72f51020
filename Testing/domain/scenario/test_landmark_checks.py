"""Landmarks that cannot be used are named, each with what would be right."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.points import Landmark, check_landmarks, on_skin, spread_first
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(asset_path("scenarios", "colin27"))


@pytest.fixture(scope="module")
def mesh(scenario):
    return read_head_mesh(scenario.head_mesh)


def placed(scenario, **moved):
    """Return the scenario's landmarks, some of them somewhere else; names have _ for spaces."""
    places = {each.name: each.position for each in scenario.landmarks}
    places |= {name.replace("_", " "): np.array(place) for name, place in moved.items()}
    return [Landmark(name, place) for name, place in places.items()]


def test_the_landmarks_of_the_default_head_can_be_used(scenario, mesh):
    assert check_landmarks(mesh, scenario.landmarks) == []
    assert [each.name for each in scenario.landmarks[:3]] == [
        each.name for each in spread_first(scenario.landmarks)[:3]
    ]


def test_too_few_and_too_many_are_named(scenario, mesh):
    for count, landmarks in ((2, scenario.landmarks[:2]), (16, scenario.landmarks[:1] * 16)):
        (sentence,) = check_landmarks(mesh, landmarks)
        assert sentence == f"The head has {count} landmarks; place 3 to 15 of them."


def test_a_landmark_off_the_skin_is_named_and_one_near_it_is_moved_onto_it(scenario, mesh):
    nasion = scenario.landmarks[0].position
    off = placed(scenario, Nasion=nasion + np.array([0.0, 9.0, 0.0]))
    (sentence,) = check_landmarks(mesh, off)
    assert sentence.startswith("Nasion is ")
    assert sentence.endswith(" mm off the skin; place it within 5 mm.")
    near = placed(scenario, Nasion=nasion + np.array([0.0, 3.0, 0.0]))
    assert check_landmarks(mesh, near) == []
    moved = on_skin(mesh, near)
    assert np.linalg.norm(moved[0].position - nasion) < 2.0
    assert on_skin(mesh, off)[0].position.tolist() == off[0].position.tolist()


def test_swapped_sides_are_named_once_for_both(scenario, mesh):
    own = {each.name: each.position for each in scenario.landmarks}
    swapped = placed(
        scenario,
        Right_inner_canthus=own["Left inner canthus"],
        Left_inner_canthus=own["Right inner canthus"],
    )
    assert check_landmarks(mesh, swapped) == [
        "Right inner canthus and Left inner canthus are swapped; R is positive on the patient's "
        "right."
    ]
    other = placed(scenario, Left_tragus=own["Left tragus"] * [-1.0, 1.0, 1.0])
    assert "Left tragus is on the patient's right; R is positive on the right." in check_landmarks(
        mesh, other
    )


def test_landmarks_at_one_place_twice_or_in_a_line_are_named(scenario, mesh):
    own = {each.name: each.position for each in scenario.landmarks}
    close = placed(scenario, Brow=own["Nasion"] + [0.0, 0.0, 4.0])
    assert any("are 4.0 mm apart" in sentence for sentence in check_landmarks(mesh, close))
    twice = [*scenario.landmarks, Landmark("Nasion", own["Left inner canthus"] + [0, 0, 12.0])]
    assert "Nasion is placed 2 times; keep one." in check_landmarks(mesh, twice)
    names = ("Nasion", "Right inner canthus", "Left inner canthus")
    (sentence,) = check_landmarks(mesh, [Landmark(name, own[name]) for name in names])
    assert "are almost in a line" in sentence
