"""The scripted trainee finds its way around heads of every shape."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import play_virtual_trial
from rastrainer_simulator.virtual.scripted_trainee import LIFT_MM
from Testing.simulator.authoring.planned_heads import setup_of

DT = 0.05


@pytest.mark.parametrize(
    ("head", "task"),
    [
        # The fiducials are on both sides of the neck: the direct path leads under the head.
        ("small", "task-5"),
        # Coming from below, the arm reaches a point with its shaft at the skin.
        ("egg", "task-3"),
    ],
    ids=["path under the head", "shaft at the skin"],
)
def test_all_fiducials_are_reached_and_the_tip_never_goes_under_the_head(head, task, tmp_path):
    setup, heights = setup_of(head, tmp_path), []

    def note(_simulation, _before, _operator_input, result):
        if result.state.training.touches:
            heights.append(MM_PER_M * result.state.tool_tip_to_world[2, 3])

    simulation, scenario = Simulation(setup, 1), setup.scenario
    play_virtual_trial(simulation, task, 1, Skill(), DT, note)
    head_to_world = scenario.perturbed_head_to_world(1)
    fiducials = transforms.apply(head_to_world, scenario.task(task).fiducials)
    touches = MM_PER_M * np.array([one.position for one in simulation.state.training.touches])
    assert len(touches) == 15
    assert np.linalg.norm(touches - fiducials, axis=1).max() < 6.0
    assert min(heights) > fiducials[:, 2].min() - 2 * LIFT_MM


def test_slow_moving_hands_touch_only_once_they_have_arrived(setup):
    """The path over the head takes them longer than they would aim."""
    skill = Skill(speed_mm_s=54.0, gain_per_s=1.35, slip_at=None)
    refused = []

    def note(_simulation, _before, operator_input, result):
        for command, answer in zip(operator_input.commands, result.answers, strict=True):
            if command.name == "Capture" and not answer.ok:
                refused.append(answer.message)

    simulation = Simulation(setup, 1)
    play_virtual_trial(simulation, "task-5", 1, skill, DT, note)
    assert len(simulation.state.training.touches) == 15
    assert refused == []
