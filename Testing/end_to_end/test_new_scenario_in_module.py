"""A few clicks in the module lead from a volume to a running trial."""

from __future__ import annotations

import numpy as np
import pytest
import slicer

from rastrainer.scenario.library import user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.head.volume import Volume
from rastrainer.slicer.scene.nodes import Role
from Testing.end_to_end.module.story import Story, unfold
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.volume_file import write_volume
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)
from Testing.slicer.host.sample_data import SampleDataLogic

SAMPLE_SHAPE, SAMPLE_SPACING = (256, 256, 112), (0.9375, 0.9375, 1.4)
"""Of MRBrainTumor1."""


def load_volume(scene, path, name):
    """Load a file as Slicer does: the slice views show the volume that was loaded last."""
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", name)
    storage = scene.AddNewNodeByClass("vtkMRMLVolumeArchetypeStorageNode")
    storage.SetFileName(str(path))
    assert storage.ReadData(node)
    application = slicer.app.applicationLogic()
    application.GetSelectionNode().SetActiveVolumeID(node.GetID())
    application.PropagateVolumeSelection()
    return node


@pytest.fixture
def provide_sample(host, tmp_path, monkeypatch):
    """Returns a function that has Sample Data download a scan."""

    def provide(scan):
        path = write_volume(tmp_path / "sample.nrrd", scan)
        download = lambda _logic, name: [load_volume(host.scene, path, name)]  # noqa: E731
        monkeypatch.setattr(SampleDataLogic, "downloadSamples", download)

    return provide


def test_the_sample_is_loaded_into_the_scene_and_selected_by_one_click(host, provide_sample):
    provide_sample(Volume(np.zeros(SAMPLE_SHAPE, np.float32), np.diag([*SAMPLE_SPACING, 1.0])))
    host.open()
    unfold(host, "newScenarioCollapsibleButton")
    host.press("sampleDataButton")
    assert host.messages == []
    chosen = host.find("scanComboBox").currentNode()
    assert chosen.GetName() == "MRBrainTumor1"
    assert chosen.GetImageData().GetDimensions() == SAMPLE_SHAPE
    assert chosen.GetSpacing() == pytest.approx(SAMPLE_SPACING)
    assert host.find("makeScenarioButton").enabled


def test_a_sample_that_cannot_be_downloaded_is_reported_and_nothing_is_selected(host, monkeypatch):
    host.open()
    unfold(host, "newScenarioCollapsibleButton")
    monkeypatch.setattr(SampleDataLogic, "downloadSamples", lambda _logic, _name: [None])
    host.press("sampleDataButton")
    assert "could not be downloaded" in host.messages[-1].text
    assert host.find("scanComboBox").currentNode() is None
    assert not host.find("makeScenarioButton").enabled


@pytest.mark.soak
def test_a_trial_on_the_sample_takes_a_few_clicks_from_its_download(host, tmp_path, provide_sample):
    story = Story(host, tmp_path, ("--no-views", "--no-gamepad"))
    story.choose_own_program()
    story.start_simulator()
    story.create_trainee()
    # Turned in the scanner, and nearly as wide as an adult's.
    shape = {"spacing": SAMPLE_SPACING, "shape": SAMPLE_SHAPE}
    provide_sample(phantom(**shape, turn_deg=7.0, noise=3.0, size=1.1))
    unfold(host, "newScenarioCollapsibleButton")
    host.press("sampleDataButton")
    host.press("makeScenarioButton")
    assert host.messages == []
    combo = host.find("scenarioComboBox")
    host.wait_until(lambda: "MRBrainTumor1" in combo.currentText, "it is chosen")
    host.wait_until(lambda: host.find("startTrialRunButton").enabled, "a trial may start")
    host.press("startTrialRunButton")
    host.wait_until(lambda: "running" in host.text("phaseText"), "the trial runs")
    scenario = load_scenario(user_library() / "mrbraintumor1")
    assert len(scenario.tasks) == 6

    def shown_images():
        """The new head's images; the previous head's images are shown until they are read."""
        images = Role.HEAD_VOLUME.find(host.scene)
        is_new = images and images.GetName() == "MRBrainTumor1" and images.GetImageData()
        return images if is_new else None

    host.wait_until(shown_images, "its images are shown")
    assert shown_images().GetDisplayNode().GetWindow() == scenario.volume.window
    story.stop_simulator()
