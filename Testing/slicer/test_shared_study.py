"""Two Slicers may work with one study: each sees what the other does, and neither waits."""

import sqlite3

import pytest

from rastrainer.sections.trainees_logic import LOOK_EVERY_S, TraineeLogic
from rastrainer.study.database.study import Study


@pytest.fixture
def logic(study_place, tmp_path):
    """A logic whose time the test sets."""
    times = [0.0]
    logic = TraineeLogic(lambda: Study.open(study_place), tmp_path, clock=lambda: times[0])
    logic.wait = lambda: times.append(times.pop() + LOOK_EVERY_S)
    logic.study.trainees()
    logic.wait()
    assert not logic.hasChangedElsewhere()
    yield logic
    logic.close()


def test_a_trainee_added_by_another_slicer_is_noticed_once_and_our_own_never(logic, study_place):
    logic.create("Green", consent=False)
    logic.wait()
    assert not logic.hasChangedElsewhere()
    with Study.open(study_place) as other:
        other.create_trainee("Blue")
    assert not logic.hasChangedElsewhere()
    logic.wait()
    assert logic.hasChangedElsewhere()
    logic.wait()
    assert not logic.hasChangedElsewhere()


@pytest.mark.parametrize("study_place", ["sqlite"], indirect=True)
def test_a_locked_study_is_checked_later(logic, study_place):
    other = sqlite3.connect(study_place, isolation_level=None)
    other.execute("BEGIN EXCLUSIVE")
    logic.wait()
    assert not logic.hasChangedElsewhere()
    other.execute("INSERT INTO trainees VALUES (NULL, 'Blue', 0, 0, '2026-01-01T00:00:00Z')")
    other.execute("COMMIT")
    other.close()
    logic.wait()
    assert logic.hasChangedElsewhere()
