"""Parts of the arm that cover tip or point are translucent."""

from dataclasses import replace

import pytest

from rastrainer.protocol import Phase, RegistrationMethod
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.viewpoint.arm_cover import places_to_see

STEP_M = 0.001


@pytest.fixture
def state(setup):
    return Simulation(setup, 3).state


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
