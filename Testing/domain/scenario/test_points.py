"""Tasks of fifteen fiducials, landmarks and their checks."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import read_head_mesh
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.points import (
    LABELS,
    Landmark,
    check_landmarks,
    on_skin,
    read_fiducials,
    spread_first,
    touch_order,
)
from rastrainer.scenario.scenario import load_scenario, method_of, task_by_method
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import landmarks_sha256, scenario_sha256
from Testing.simulator.landmarked import write_landmarked

POINTS = np.random.default_rng(2).uniform(-90, 90, (15, 3)).round(4)


@pytest.mark.parametrize(
    ("labels", "points", "sentence"),
    [
        pytest.param(LABELS[:14], POINTS[:14], "15 points labeled", id="one missing"),
        pytest.param(LABELS[::-1], POINTS, "in the order to touch", id="wrong order"),
        pytest.param(LABELS, np.vstack([POINTS[:14], POINTS[:1]]), "same place", id="one twice"),
    ],
)
def test_an_invalid_task_file_is_refused_with_a_message(tmp_path, labels, points, sentence):
    path = tmp_path / "broken.mrk.json"
    write_markups(path, PointList(labels, points))
    with pytest.raises(InputError, match=sentence) as caught:
        read_fiducials(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("labels", "order"),
    [
        pytest.param([str(n) for n in range(1, 16)], list(range(15)), id="numbers"),
        pytest.param([str(n) for n in range(15, 0, -1)], list(range(14, -1, -1)), id="backward"),
        pytest.param([f"F-{n}" for n in range(2, 17)], list(range(15)), id="Slicer's, one deleted"),
        pytest.param([""] * 15, list(range(15)), id="no labels"),
        pytest.param(["left", "ear", *["nose"] * 13], list(range(15)), id="names alone"),
    ],
)
def test_touch_order_follows_the_numbers_of_labels_or_the_list(labels, order):
    assert touch_order(labels) == order


@pytest.mark.parametrize(
    ("labels", "sentence"),
    [
        pytest.param(["1", *[str(n) for n in range(1, 15)]], "two the same", id="one twice"),
        pytest.param(["nose", *[str(n) for n in range(2, 16)]], "no number", id="one without"),
    ],
)
def test_labels_without_a_clear_order_are_refused_with_a_message(labels, sentence):
    with pytest.raises(InputError, match=sentence) as caught:
        touch_order(labels)
    assert "\n" not in str(caught.value)


PLACES = [
    {"name": "Nasion", "positionRas": [0.0, 95.0, -10.0]},
    {"name": "Right tragus", "positionRas": [78.0, -8.0, -34.0]},
    {"name": "Left tragus", "positionRas": [-76.0, -8.0, -34.0]},
    {"name": "Nose tip", "positionRas": [2.0, 118.0, -42.0]},
]


@pytest.fixture
def load(tmp_path):
    """Load the default scenario with other landmarks."""
    folders = (tmp_path / str(number) for number in itertools.count())
    return lambda landmarks: load_scenario(write_landmarked(next(folders), landmarks))


def test_each_method_has_its_own_points_to_touch(load):
    scenario = load(PLACES)
    labels = {
        method: task_by_method(scenario, "task-1", method).labels
        for method in map(method_of, ("", "landmarks", "surface", "landmarks-surface"))
    }
    names = tuple(place["name"] for place in PLACES)
    assert labels[RegistrationMethod.FIDUCIALS] == scenario.task("task-1").labels
    assert labels[RegistrationMethod.LANDMARKS] == names
    assert labels[RegistrationMethod.SURFACE] == names[:3]
    assert labels[RegistrationMethod.LANDMARKS_SURFACE] == names
    touched = task_by_method(scenario, "task-1", RegistrationMethod.SURFACE)
    np.testing.assert_array_equal(touched.fiducials, [p["positionRas"] for p in PLACES[:3]])


def test_journals_of_fiducial_trials_stay_valid_when_landmarks_are_placed_later(load):
    one, other = load([]), load(PLACES)
    assert scenario_sha256(one) == scenario_sha256(other)
    assert landmarks_sha256(one) != landmarks_sha256(other)


@pytest.fixture(scope="module")
def scenario():
    return load_scenario(asset_path("scenarios", "colin27"))


@pytest.fixture(scope="module")
def mesh(scenario):
    return read_head_mesh(scenario.head)


def placed(scenario, **moved):
    """Return the scenario's landmarks, some of them somewhere else; names have _ for spaces."""
    places = {each.name: each.position_ras for each in scenario.landmarks}
    places |= {name.replace("_", " "): np.array(place) for name, place in moved.items()}
    return [Landmark(name, place) for name, place in places.items()]


def test_the_landmarks_of_the_default_head_are_usable(scenario, mesh):
    assert check_landmarks(mesh, scenario.landmarks) == []
    assert [each.name for each in scenario.landmarks[:3]] == [
        each.name for each in spread_first(scenario.landmarks)[:3]
    ]


def test_a_landmark_off_the_skin_is_named_and_one_near_it_is_moved_onto_it(scenario, mesh):
    nasion = scenario.landmarks[0].position_ras
    off = placed(scenario, Nasion=nasion + np.array([0.0, 9.0, 0.0]))
    (sentence,) = check_landmarks(mesh, off)
    assert sentence.startswith("Nasion is ")
    assert sentence.endswith(" mm off the skin; place it within 5 mm.")
    near = placed(scenario, Nasion=nasion + np.array([0.0, 3.0, 0.0]))
    assert check_landmarks(mesh, near) == []
    moved = on_skin(mesh, near)
    assert np.linalg.norm(moved[0].position_ras - nasion) < 2.0
    assert on_skin(mesh, off)[0].position_ras.tolist() == off[0].position_ras.tolist()


def test_swapped_sides_are_named_once_for_both(scenario, mesh):
    own = {each.name: each.position_ras for each in scenario.landmarks}
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
