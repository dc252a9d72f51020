"""Fiducials placed by hand: moved onto the skin, or refused."""

import numpy as np
import pytest

from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import nearest_on_mesh, outward_normals
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.writer import HeadDraft
from rastrainer_simulator.authoring.make import ScenarioOptions, without_tasks
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.scenario_check import read_placed_tasks
from Testing.simulator.authoring.heads import egg
from Testing.slicer.head.placed import fiducials


@pytest.fixture(autouse=True)
def _few_poses(monkeypatch):
    """Try the reach in the nominal pose and in one other."""
    monkeypatch.setattr("rastrainer_simulator.authoring.scenario_check.POSES_TRIED", 1)


@pytest.fixture
def unchecked(monkeypatch):
    """Skip the check of tasks that were read."""
    monkeypatch.setattr("rastrainer_simulator.authoring.scenario_check.check_tasks", lambda *_: [])


@pytest.fixture(scope="module")
def planning():
    head = egg()
    scenario = without_tasks(
        HeadDraft(head, "made up"), ScenarioOptions("An egg", "made up", "none")
    )
    return PlanningSetup(scenario, head)


@pytest.fixture(scope="module")
def on_skin(planning):
    """Fifteen places on the crown, (15, 3)."""
    return np.array([nearest_on_mesh(planning.mesh, 1.4 * place).position for place in fiducials()])


def read(planning, folder, points, labels=LABELS, count=1):
    """Return the tasks of files with these points, their errors, and the warnings."""
    path, warnings = folder / "mine.mrk.json", []
    write_markups(path, PointList(labels, points))
    files = (path,) * count
    result = read_placed_tasks(planning, files, lambda _step, _share: None, warnings.append)
    return *result, warnings


@pytest.mark.usefixtures("unchecked")
def test_clicks_within_five_millimeters_of_the_skin_are_moved_onto_it_and_that_is_reported(
    planning, on_skin, tmp_path
):
    lifted = on_skin + np.linspace(-4.5, 4.5, 15)[:, None] * outward_normals(planning.mesh, on_skin)
    (task,), wrong, warnings = read(planning, tmp_path, lifted)
    assert wrong == []
    assert len(warnings) == 1
    assert warnings[0].startswith("Trial run: 14 fiducials were moved onto the skin, by at most 4.")
    away = [nearest_on_mesh(planning.mesh, point).distance for point in task.fiducials]
    assert max(away) < 1e-3
    assert np.linalg.norm(task.fiducials - on_skin, axis=1).max() < 2.0


def test_clicks_farther_away_are_named_with_their_distance(planning, on_skin, tmp_path):
    points = on_skin.copy()
    points[2] *= 1.1
    points[11] *= 0.9
    tasks, wrong, _ = read(planning, tmp_path, points)
    assert tasks == ()
    (sentence,) = wrong
    assert sentence.startswith("Trial run: off the skin by more than 5 mm: 3 (")
    assert "12 (" in sentence


def test_an_invalid_list_and_a_seventh_list_are_refused(planning, on_skin, tmp_path):
    _, wrong, _ = read(planning, tmp_path, on_skin[:14], LABELS[:14])
    assert wrong == ["Trial run: it has 14 fiducials; a task has 15."]
    twice = on_skin.copy()
    twice[7] = twice[6]
    assert read(planning, tmp_path, twice)[1] == ["Trial run: two fiducials are at the same place."]
    _, wrong, _ = read(planning, tmp_path, on_skin, count=7)
    assert wrong == ["A scenario has at most 6 tasks; 7 are given."]
