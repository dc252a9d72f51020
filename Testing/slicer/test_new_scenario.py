"""The sections Scenario and New scenario without a simulator: lists, files, set-up, sentences."""

import sys
import zipfile

import numpy as np
import pytest
import slicer

from rastrainer.head.trial_head import Perturbation
from rastrainer.scenario.library import pack, user_library
from rastrainer.scenario.setup import SetUp
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer.sections import new_scenario_logic, scenario_files, scenario_logic
from rastrainer.sections.new_scenario_logic import editedHead
from rastrainer.slicer.head.volume import HeadSettings, Volume
from rastrainer.slicer.scene.nodes import Role, setPoints
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario, png
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.placed import add_transform, add_volume
from Testing.slicer.host.cancels import cancels

SIZE = 0.75
SPACING = (3.5, 3.5, 3.5)
"""Size of the heads, and spacing of their images, mm: these are found faster."""

EMPTY = Volume(np.zeros((16, 16, 16), np.float32), np.eye(4))


@pytest.fixture
def host(fresh_module):
    return fresh_module


@pytest.fixture
def package(tmp_path):
    with new_folder(tmp_path / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
        (made / "preview.png").write_bytes(png())
    return pack(tmp_path / "ball", tmp_path / "ball.zip")


def found_once(find):
    """Return a function that finds the same head each time, which takes long only once."""
    found = []

    def find_once(*arguments):
        found[:] = found or [find(*arguments)]
        return found[0]

    return find_once


def add_zip(host, path):
    host.answer("Add a scenario", path)
    host.press("importScenarioButton")


def test_zip_files_are_added_listed_with_their_picture_or_refused(start_slicer, package, tmp_path):
    host, bad = start_slicer(), tmp_path / "bad.zip"
    with zipfile.ZipFile(bad, "w") as archive:
        archive.writestr("../../evil.txt", "x")
    add_zip(host, bad)
    assert "holds a file with the path" in host.messages[-1].text
    assert not user_library().exists()
    broken = user_library() / "broken"
    broken.mkdir(parents=True)
    (broken / "scenario.json").write_text("{")
    add_zip(host, package)
    assert host.find("scenarioComboBox").currentText == "A ball"
    assert host.find("scenarioPicture").visible
    assert (user_library() / "ball" / "scenario.json").is_file()
    assert host.find("taskComboBox").count == 3
    add_zip(host, package)
    assert "already" in host.messages[-1].text
    host.choose("scenarioComboBox", "broken")
    assert "scenario.json" in host.text("scenarioText")
    assert not host.find("showScenarioButton").enabled
    host.choose("scenarioComboBox", "A ball")
    assert host.find("removeFaceCheckBox").checked
    host.answer("Save the scenario", tmp_path / "out.zip")
    host.press("exportScenarioButton")
    assert "press Set up first" in host.messages[-1].text
    assert not (tmp_path / "out.zip").exists()


def test_a_found_head_is_kept_as_a_segment_where_its_volume_is_until_a_scenario_is_made(
    host, monkeypatch
):
    made = host.widget.logic.session.scenarios.find("colin27")
    monkeypatch.setattr(new_scenario_logic, "planScenario", lambda *_arguments: [])
    monkeypatch.setattr(scenario_files, "load_scenario", lambda _folder: made)
    volume = add_volume(host.scene, phantom(spacing=SPACING, size=SIZE), "MRI")
    volume.SetAndObserveTransformNodeID(add_transform(host.scene, [0.0, 0.0, 100.0]).GetID())
    rendering = host.scene.AddNode(slicer.vtkMRMLCPURayCastVolumeRenderingDisplayNode())
    volume.AddAndObserveDisplayNodeID(rendering.GetID())
    host.choose("scanComboBox", volume)
    host.type("thresholdSpinBox", "150")
    host.press("previewHeadButton")
    assert "no voxel lies above the threshold" in host.messages.pop().text
    assert Role.HEAD_PREVIEW.find(host.scene) is None
    monkeypatch.setattr(new_scenario_logic, "findSkin", found_once(scenario_logic.findSkin))
    host.type("thresholdSpinBox", str(host.find("thresholdSpinBox").minimum))
    host.type("cutSpinBox", "65")
    host.press("previewHeadButton")
    assert "This is the head that was found" in host.text("newScenarioText")
    assert "The slices are 3.5 mm apart" in host.text("newScenarioText")
    draft = Role.HEAD_SEGMENT.find(host.scene), Role.HEAD_PREVIEW.find(host.scene)
    assert draft[0].GetSegmentation().GetNumberOfSegments() == 1
    bounds = draft[1].GetPolyData().GetBounds()
    assert bounds[4] == pytest.approx(65.0, abs=0.01)
    assert bounds[5] == pytest.approx(100.0 + 70.0 * SIZE, abs=3.0)
    settings = HeadSettings(baseMm=65.0)
    assert editedHead(volume, settings) is not None
    assert editedHead(add_volume(host.scene, EMPTY, "other"), settings) is None
    host.type("thresholdSpinBox", "60")
    host.press("makeScenarioButton")
    assert "changed since the head was found" in host.messages.pop().text
    assert not user_library().exists()
    host.type("thresholdSpinBox", str(host.find("thresholdSpinBox").minimum))
    assert all(node.GetDisplayVisibility() for node in draft)
    host.type("programPathLineEdit", sys.executable)
    host.press("makeScenarioButton")
    assert "was made" in host.text("newScenarioText")
    assert not any(node.GetDisplayVisibility() for node in draft)
    assert not rendering.GetVisibility()
    host.press("previewHeadButton")
    host.type("cutSpinBox", str(host.find("cutSpinBox").minimum))
    assert host.messages == []
    assert all(node.GetDisplayVisibility() for node in draft)


@pytest.mark.usefixtures("own_processes")
def test_a_volume_without_an_image_is_refused_and_a_canceled_preview_leaves_nothing_behind(host):
    host.scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Empty")
    host.choose("scanComboBox", host.scene.GetFirstNodeByName("Empty"))
    for number, button in enumerate(
        ("previewHeadButton", "checkScenarioButton", "makeScenarioButton"), start=1
    ):
        host.press(button)
        assert "holds no image" in host.messages[-1].text
        assert len(host.messages) == number
    volume = add_volume(host.scene, phantom(spacing=SPACING, size=SIZE), "MRI")
    host.choose("scanComboBox", volume)
    before = host.scene.GetNumberOfNodes()
    with cancels(host, "makeScenarioButton"):
        host.press("previewHeadButton")
    assert host.text("newScenarioText") == "Canceled; nothing has changed."
    assert host.find("previewHeadButton").enabled
    assert not host.find("newScenarioProgressBar").visible
    assert host.scene.GetNumberOfNodes() == before


def wanted(host):
    """Return the options that the section New scenario shows."""
    panels = host.widget._panels._panels
    (panel,) = [each for each in panels if type(each).__name__ == "NewScenarioPanel"]
    return panel._wanted()


def test_set_up_origin_and_a_plan_in_the_scene_are_included_in_the_scenario(host):
    assert wanted(host).setUp == SetUp()
    for name, value in (("head0", 500), ("shift0", 3), ("turn0", 180), ("base1", -40)):
        host.type(f"{name}SpinBox", str(value))
    targets = host.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "Targets")
    setPoints(targets, ("Tumor", "Cyst"), np.array([[1.0, 2, 3], [4, 5, 6]]))
    line = host.scene.AddNewNodeByClass("vtkMRMLMarkupsLineNode", "Biopsy")
    setPoints(line, ("a", "b"), np.array([[0.0, 0, 90], [1, 2, 3]]))
    host.choose("plannedTargetsComboBox", targets)
    host.choose("plannedTrajectoryComboBox", line)
    for name in ("handPlacedCheckBox", "skullCheckBox", "volumeCheckBox"):
        host.check(name, not host.find(name).checked)
    host.type("sourceLineEdit", "The Head Study")
    host.type("licenseLineEdit", "CC BY 4.0")
    wishes = wanted(host)
    assert wishes.setUp.head.center_mm == (500.0, 0.0, 220.0)
    assert wishes.setUp.perturbation == Perturbation(3.0, 180.0, 3.0)
    assert wishes.setUp.robot_base_mm == (0.0, -40.0)
    assert (wishes.hasSkull, wishes.hasVolume, wishes.isHandPlaced) == (False, False, True)
    assert (wishes.source, wishes.license) == ("The Head Study", "CC BY 4.0")
    assert scenario_files.planArguments(wishes.targets, wishes.trajectory) == [
        *("--target", "Tumor", "1.0", "2.0", "3.0", "--target", "Cyst", "4.0", "5.0", "6.0"),
        *("--trajectory", "Biopsy", "0.0", "0.0", "90.0", "1.0", "2.0", "3.0"),
    ]
