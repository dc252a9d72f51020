"""Parts of the arm that cover tip or point are translucent."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.protocol import Phase, RegistrationMethod
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.viewpoint.arm_cover import ArmCover, places_to_see
from Testing.simulator.viewpoint.covered_views import count_covered

STEP_M = 0.001


def test_the_best_view_of_any_posture_shows_tip_and_point_which_the_planned_one_hides(setup):
    counts = count_covered(setup, 7, setup.scenario.task("task-5"), count=3, every=4)
    planned, *present = counts.values()
    assert planned["covered"] > 0.05 * planned["views"]
    assert [count["covered"] for count in present] == [0, 0], counts
    # Elsewhere what covers them is translucent, and besides it only what almost does.
    assert planned["hidden"] == 0, planned
    assert planned["needless"] < 0.4 * planned["views"]


@pytest.fixture
def state(setup):
    return Simulation(setup, 3).state


def test_a_link_at_the_edge_of_the_line_of_sight_does_not_flicker(setup, state):
    cover = ArmCover(setup)
    link = state.link_to_world[3][:3, 3]
    seen = {}
    offsets = np.arange(0.0, 0.2, STEP_M)
    for name, moved in (("in", offsets[::-1]), ("out", offsets)):
        for offset in moved:
            eye = link + np.array((-1.0, offset, 0.0))
            (found,) = cover.covering(
                state, {"view": eye}, [eye + np.array((2.0, 0.0, 0.0))]
            ).values()
            if ("link_3" in found) is (name == "in"):
                seen.setdefault(name, offset)
    assert seen["out"] - seen["in"] == pytest.approx(0.01, abs=2.5 * STEP_M)


def test_only_marked_points_of_an_open_trial_make_links_translucent(setup, state):
    task = setup.scenario.tasks[1]
    training = replace(state.training, phase=Phase.RUNNING, task=task.name, next_point="2")
    marked = replace(state, training=training)
    point = state.head_to_world @ [*task.fiducials[1] / 1000.0, 1.0]
    tip, next_point = places_to_see(marked, setup.scenario)
    assert tip == pytest.approx(state.tool_tip_to_world[:3, 3])
    assert next_point == pytest.approx(point[:3])
    # Landmarks have to be found: no translucent part may tell where one is.
    unmarked = replace(marked, training=replace(training, method=RegistrationMethod.LANDMARKS))
    assert len(places_to_see(unmarked, setup.scenario)) == 1
    assert places_to_see(state, setup.scenario) == []
