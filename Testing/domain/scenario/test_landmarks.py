"""Landmarks of a scenario, and what a method of registration has a trial touch."""

import itertools

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import load_scenario, method_of, task_by_method
from rastrainer_simulator.core.setup import landmarks_sha256, scenario_sha256
from Testing.simulator.landmarked import write_landmarked

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


def test_each_method_has_its_own_points_touched(load):
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


def test_the_journals_of_fiducials_stay_valid_where_landmarks_are_placed_later(load):
    one, other = load([]), load(PLACES)
    assert scenario_sha256(one) == scenario_sha256(other)
    assert landmarks_sha256(one) != landmarks_sha256(other)


@pytest.mark.parametrize(
    ("landmarks", "said"),
    [
        pytest.param([PLACES[0], PLACES[0]], "name must be another name", id="same name"),
        pytest.param([{"name": "Nasion"}], "positionRas", id="no place"),
        pytest.param(PLACES * 4, "list of 0 to 15", id="too many"),
    ],
)
def test_landmarks_that_are_unusable_are_named(load, landmarks, said):
    with pytest.raises(InputError, match=said):
        load(landmarks)
