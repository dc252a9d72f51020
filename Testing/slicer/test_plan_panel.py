"""The section Plan while a simulator is connected: its sentences about the shown plan."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer_simulator.assets import asset_path
from Testing.slicer.simulator_double import SimulatorDouble, connect_module

ANSWERS = {CommandName.PLAN_TARGET: {"reachable": True, "reason": ""}}


@pytest.fixture
def planner(host):
    """The module, connected, with a registered head and a planned target."""
    with SimulatorDouble(lambda name, _arguments: ANSWERS.get(name, {})) as simulator:
        host.open()
        connect_module(host, simulator)
        host.press("showScenarioButton")
        colin = load_scenario(asset_path("scenarios", "colin27"))
        noise = np.random.default_rng(3).normal(0.0, 0.6, (15, 3))
        fiducials = colin.task("task-1").fiducials
        touched = transforms.apply(colin.perturbed_head_to_world(3), fiducials + noise)
        setPoints(Role.CAPTURED_POINTS.make(host.scene), LABELS, touched)
        # The mouse would place the point in a list that is added later.
        host.finish_work()
        host.press("placeTargetButton")
        host.place(10.0, 20.0, 0.0)
        host.wait_until(lambda: "target x" in host.text("planWorldText"), "the plan is mapped")
        yield host


def test_reachability_is_shown_only_for_the_plan_that_was_sent(planner):
    planner.press("sendPlanButton")
    planner.wait_until(lambda: "can carry it out" in planner.text("reachableText"), "the answer")
    planner.idle_for(0.3)
    assert "can carry it out" in planner.text("reachableText")
    planner.press("placeTargetButton")
    planner.place(-30.0, 10.0, 5.0)
    planner.wait_until(lambda: "show it again" in planner.text("reachableText"), "the hint")
    planner.press("sendPlanButton")
    planner.wait_until(lambda: "can carry it out" in planner.text("reachableText"), "the answer")
    planner.choose("planTargetComboBox", 0)
    planner.wait_until(lambda: "show it again" in planner.text("reachableText"), "the hint")
