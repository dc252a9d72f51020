"""From a volume to a running trial in the module, by few clicks."""

from __future__ import annotations

import pytest

from rastrainer.scenario import load_scenario
from rastrainer.scenario_library import user_library
from rastrainer.slicer.control_points import setPoints
from rastrainer.slicer.scene import Role, findNode
from rastrainer.tasks import LABELS
from Testing.end_to_end.module.story import Story, unfold
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.placed import add_volume, fiducials
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)
from Testing.slicer.host.other_modules import SampleDataLogic


class Clicks:
    """Counts what a user clicks."""

    def __init__(self, host):
        self.count = 0
        self._host = host

    def unfold(self, name):
        self.count += 1
        unfold(self._host, name)

    def press(self, name):
        self.count += 1
        self._host.press(name)

    def choose(self, name, choice):
        self.count += 1
        self._host.choose(name, choice)


@pytest.fixture(autouse=True)
def session_under_way(host, tmp_path):
    """A session under way: the simulator runs, and a trainee is chosen."""
    story = Story(host, tmp_path, ("--no-views", "--no-gamepad"))
    story.choose_own_program()
    story.start_simulator()
    story.create_trainee()
    yield
    story.stop_simulator()


def trains_on(host, title, button):
    """Start a trial by a button, and wait until it runs on that scenario."""
    host.wait_until(lambda: title in host.find("scenarioComboBox").currentText, "it is chosen")
    host.wait_until(lambda: host.find(button).enabled, "a trial may start")
    host.press(button)
    host.wait_until(lambda: "running" in host.text("phaseText"), "the trial runs")
    head = findNode(host.scene, "vtkMRMLModelNode", Role.HEAD_MODEL)
    combo = host.find("scenarioComboBox")
    assert head.GetAttribute("RASTrainer.scenario") == combo.itemData(combo.currentIndex)


def test_a_volume_with_fiducials_placed_by_hand_is_trained_on_by_five_clicks(host):
    volume = add_volume(host.scene, phantom(spacing=(2.0, 2.0, 2.0)), "Ms X")
    placed = host.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "By hand")
    setPoints(placed, LABELS, fiducials())
    unfold(host, "planForScenarioGroupBox")
    host.find("handPlacedCheckBox").checked = True
    clicks = Clicks(host)
    clicks.unfold("newScenarioCollapsibleButton")
    clicks.choose("scanComboBox", volume)
    clicks.press("makeScenarioButton")
    assert host.messages == []
    assert "is made" in host.text("newScenarioText")
    assert host.find("scenarioPicture").visible
    trains_on(host, "Ms X", "startTrialRunButton")
    clicks.count += 1
    assert clicks.count <= 5
    library = user_library()
    assert [path.name for path in library.iterdir()] == ["ms-x"]
    scenario = load_scenario(library / "ms-x")
    assert [task.title for task in scenario.tasks] == ["Trial run"]


@pytest.mark.soak
def test_the_sample_is_trained_on_by_five_clicks_from_its_download_on(host, monkeypatch):
    sample = phantom(spacing=(0.9375, 0.9375, 1.4), turn_deg=7.0, noise=3.0)

    def download(_logic, name):
        return add_volume(host.scene, sample, name)

    monkeypatch.setattr(SampleDataLogic, "downloadSample", download)
    clicks = Clicks(host)
    clicks.unfold("newScenarioCollapsibleButton")
    clicks.press("sampleDataButton")
    clicks.press("makeScenarioButton")
    assert host.messages == []
    trains_on(host, "MRBrainTumor1", "startTrialRunButton")
    clicks.count += 1
    assert clicks.count <= 5
    assert host.find("taskComboBox").count == 6
