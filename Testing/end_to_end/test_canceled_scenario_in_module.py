"""Cancel in the module leaves nothing of a scenario that is being made."""

from __future__ import annotations

import threading

from rastrainer.scenario.library import user_library
from rastrainer.scenario.points import LABELS
from rastrainer.sections import new_scenario_logic
from rastrainer.slicer.scene.nodes import setPoints
from Testing.end_to_end.module.story import Story, unfold
from Testing.running_process import runs
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.placed import add_volume, fiducials
from Testing.slicer.host.cancels import cancels
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)

SIZE = 0.75


def test_a_scenario_canceled_while_its_head_is_extracted_or_planned_on_leaves_nothing_behind(
    host, tmp_path, monkeypatch
):
    # A scan is chosen, with fiducials placed by hand and a program that plans on it.
    Story(host, tmp_path).choose_own_program()
    unfold(host, "newScenarioCollapsibleButton")
    unfold(host, "adjustHeadGroupBox")
    unfold(host, "planForScenarioGroupBox")
    placed = host.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "By hand")
    setPoints(placed, LABELS, fiducials(SIZE))
    host.check("handPlacedCheckBox")
    host.check("skullCheckBox", False)
    scan = phantom(spacing=(2.0, 2.0, 2.0), size=SIZE)
    host.choose("scanComboBox", add_volume(host.scene, scan, "Ms X"))
    pid_file, is_canceled = tmp_path / "simulator.pid", threading.Event()
    with monkeypatch.context() as patched:
        # The head is not finished before, however late it is canceled.
        patched.setattr(new_scenario_logic, "write_draft", lambda *_draft: is_canceled.wait(120))
        with cancels(host, "makeScenarioButton"):
            host.press("makeScenarioButton")
        is_canceled.set()
    assert not pid_file.exists()
    assert_nothing_is_left(host)
    with cancels(host, "makeScenarioButton", lambda: pid_file.exists() and pid_file.read_text()):
        host.press("makeScenarioButton")
    host.wait_until(lambda: not runs(int(pid_file.read_text())), "the planner ends")
    assert_nothing_is_left(host)


def assert_nothing_is_left(host):
    """Check that the module is as before the scenario was started."""
    assert host.text("newScenarioText") == "Canceled; nothing has changed."
    assert host.text("makeScenarioButton") == "Make scenario"
    assert host.find("scenarioComboBox").count == 1
    assert not user_library().exists() or not list(user_library().iterdir())
