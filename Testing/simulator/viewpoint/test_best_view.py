"""Every touch has a view that shows target, number and tip; rays against the collision shapes."""

import math

import numpy as np
import pytest

from rastrainer.head.mesh import hides, outward_normals, read_head_mesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.scenario_check import check_tasks
from rastrainer_simulator.viewpoint.best_view import (
    BESIDE_DEG,
    STEEPEST_DEG,
    HeldTool,
    PointViews,
    TouchViews,
    best_view,
)
from Testing.simulator.authoring.planned_heads import setup_of

SEEDS = (None, *(pytest.param(seed, marks=pytest.mark.soak) for seed in (11, 12)))
"""Seeds of the head's poses: the nominal pose, and two of trials."""
TASKS = ("trial-run", *(f"task-{number}" for number in range(1, 6)))


HEADS = (
    ("colin27", TASKS[5]),
    ("egg", TASKS[0]),
    *(pytest.param("colin27", task, marks=pytest.mark.soak) for task in TASKS[:5]),
    *(pytest.param("egg", task, marks=pytest.mark.soak) for task in TASKS[1:]),
    *(pytest.param("small", task, marks=pytest.mark.soak) for task in TASKS),
)


@pytest.fixture(scope="module")
def made(request, tmp_path_factory):
    return setup_of(request.param, tmp_path_factory.mktemp("heads"))


@pytest.fixture(scope="module")
def mesh(made):
    return read_head_mesh(made.scenario.head)


@pytest.fixture(scope="module")
def views(made):
    return TouchViews(made)


def pose_of(scenario, seed):
    return scenario.head_to_world if seed is None else scenario.perturbed_head_to_world(seed)


def seen_in_ras(head_to_world, point):
    return np.linalg.solve(head_to_world, [*(MM_PER_M * np.array(point)), 1.0])[:3]


@pytest.mark.parametrize("seed", SEEDS, ids=str)
@pytest.mark.parametrize(("made", "task"), HEADS, indirect=["made"])
def test_every_touch_is_visible_within_60_degrees_of_the_normal(made, mesh, views, task, seed):
    scenario = made.scenario
    head_to_world = pose_of(scenario, seed)
    chosen = scenario.task(task)
    normals = outward_normals(mesh, chosen.fiducials)
    found = dict(views.of(chosen, head_to_world))
    assert [label for label, view in found.items() if view is None] == []
    for label, point, normal in zip(chosen.labels, chosen.fiducials, normals, strict=True):
        view = found[label]
        # Computed in the head's own frame, in another way than the search.
        eye = seen_in_ras(head_to_world, view.eye)
        assert not hides(mesh, eye, point + 2.0 * normal, slack_mm=0.0), label
        assert degrees(eye - point, normal) <= 60.0 + 1e-6, label
        beside = seen_in_ras(head_to_world, view.beside)
        assert not hides(mesh, beside, point + 2.0 * normal, slack_mm=0.0), label
        assert BESIDE_DEG[-1] - 1e-6 <= degrees(beside - point, normal) < 90.0, label


def degrees(a, b):
    return math.degrees(math.acos(np.dot(a, b) / np.linalg.norm(a) / np.linalg.norm(b)))


class SightFrom:
    """Leaves a point visible only from eyes whose line to it rises or falls by some degrees."""

    def __init__(self, least_deg, most_deg):
        self.range_deg = least_deg, most_deg

    def is_past_head(self, eyes, place):
        return np.array([self.is_free(eye, place) for eye in eyes])

    def is_free(self, eye, place):
        least, most = self.range_deg
        return least <= abs(90.0 - degrees(np.subtract(eye, place), (0.0, 0.0, 1.0))) < most

    def off_links(self, eyes, _place):
        return np.ones(len(eyes))

    off_tool = off_links


def test_the_view_along_the_skin_rises_or_falls_by_at_most_45_degrees():
    fiducial, normal = (0.5, 0.1, 0.3), (0.6, 0.0, 0.8)
    eyes = np.array([np.add(fiducial, 0.5 * np.array(normal))])
    mark = tuple(np.add(fiducial, 0.002 * np.array(normal)).tolist())
    views = PointViews(fiducial, normal, (mark, mark), eyes, None)

    def beside(least_deg, most_deg):
        held = HeldTool((0.5, 0.1, 0.9), (0.0, 0.0, -1.0), SightFrom(least_deg, most_deg))
        return best_view(views, [held]).beside

    assert STEEPEST_DEG == 45.0
    assert beside(0.0, 45.0) is not None
    assert beside(46.0, 91.0) is None


def test_the_check_of_a_scenario_names_what_no_view_shows(setup, monkeypatch):
    scenario = setup.scenario
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head), setup)
    task = scenario.task("task-1")
    monkeypatch.setattr("rastrainer_simulator.authoring.scenario_check.POSES_TRIED", 0)
    monkeypatch.setattr("rastrainer_simulator.viewpoint.best_view.WIDEST_DEG", 0.0)
    (sentence,) = check_tasks(planning, [task])
    assert sentence.startswith("Task 1: fiducials 1, 2, 3,")
    assert "cannot be seen within 60° of the skin's normal" in sentence
