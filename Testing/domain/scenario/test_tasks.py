"""Tasks in files, and the order in which placed fiducials are touched."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, write_markups
from rastrainer.json_checks import is_identifier
from rastrainer.scenario.points import LABELS, read_task, touch_order

POINTS = np.random.default_rng(2).uniform(-90, 90, (15, 3)).round(4)


def read(path):
    return read_task(path, "task-1", "Task 1", 12.5)


@pytest.fixture
def task_file(tmp_path):
    path = tmp_path / "task-1.mrk.json"
    write_markups(path, PointList(LABELS, POINTS))
    return path


def test_a_task_has_its_fiducials_in_the_order_to_touch(task_file):
    task = read(task_file)
    assert (task.name, task.title, task.complexity) == ("task-1", "Task 1", 12.5)
    assert task.labels == tuple(str(number) for number in range(1, 16))
    assert np.array_equal(task.fiducials, POINTS)


def test_the_fiducials_of_a_task_cannot_be_changed(task_file):
    with pytest.raises(ValueError, match="read-only"):
        read(task_file).fiducials[0, 0] = 0.0


@pytest.mark.parametrize(
    ("labels", "points", "sentence"),
    [
        pytest.param(LABELS[:14], POINTS[:14], "15 points labeled", id="one missing"),
        pytest.param(LABELS[::-1], POINTS, "in the order to touch", id="wrong order"),
        pytest.param((), POINTS, "15 points labeled", id="no labels"),
        pytest.param(LABELS, np.vstack([POINTS[:14], POINTS[:1]]), "same place", id="one twice"),
        pytest.param(LABELS, POINTS * 1e4, "not within ±2000 mm", id="in metres? far away"),
    ],
)
def test_an_invalid_task_file_is_refused_with_a_message(tmp_path, labels, points, sentence):
    path = tmp_path / "broken.mrk.json"
    write_markups(path, PointList(labels, points))
    with pytest.raises(InputError, match=sentence) as caught:
        read(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize("name", ["trial-run", "task-1", "a", "task-12-b"])
def test_valid_task_names_are_accepted(name):
    assert is_identifier(name)


@pytest.mark.parametrize(
    "name", ["", "Task 1", "task_1", "../task", "-task", "task-", "t" * 41, "é"]
)
def test_invalid_task_names_are_refused(name):
    assert not is_identifier(name)


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
        pytest.param([str(n) for n in range(1, 15)], "has 14 fiducials", id="fourteen"),
        pytest.param([str(n) for n in range(1, 17)], "has 16 fiducials", id="sixteen"),
        pytest.param(["1", *[str(n) for n in range(1, 15)]], "two the same", id="one twice"),
        pytest.param(["nose", *[str(n) for n in range(2, 16)]], "no number", id="one without"),
    ],
)
def test_labels_without_a_clear_order_are_refused_with_a_message(labels, sentence):
    with pytest.raises(InputError, match=sentence) as caught:
        touch_order(labels)
    assert "\n" not in str(caught.value)
