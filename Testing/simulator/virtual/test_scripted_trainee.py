"""The scripted trainee finds its way around heads of every shape."""

import numpy as np

from rastrainer import transforms
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import play_virtual_trial
from rastrainer_simulator.virtual.scripted_trainee import LIFT_MM
from Testing.simulator.authoring.planned_heads import setup_of

DT = 0.05


def test_all_fiducials_are_reached_and_the_tip_never_goes_under_the_head(tmp_path):
    # The fiducials are on both sides of the neck: the direct path leads under the head.
    setup, heights = setup_of("small", tmp_path), []

    def note(_simulation, _before, _operator_input, result):
        if result.state.training.touches:
            heights.append(MM_PER_M * result.state.tool_tip_to_world[2, 3])

    simulation, scenario = Simulation(setup, 1), setup.scenario
    play_virtual_trial(simulation, "task-5", 1, Skill(), DT, note)
    head_to_world = scenario.perturbed_head_to_world(1)
    fiducials = transforms.apply(head_to_world, scenario.task("task-5").fiducials)
    touches = MM_PER_M * np.array([one.position for one in simulation.state.training.touches])
    assert len(touches) == 15
    assert np.linalg.norm(touches - fiducials, axis=1).max() < 6.0
    assert min(heights) > fiducials[:, 2].min() - 2 * LIFT_MM
