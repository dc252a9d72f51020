"""The MRI of a scenario in Slicer's slice views: to view, to plan on, and to follow a trial."""

import json
import shutil
import uuid

import numpy as np
import pytest
import slicer
from PySide6 import QtGui

from rastrainer import transforms
from rastrainer.igtl.content import Status, String
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.scenario.library import user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.head.volume import imageOfNode
from rastrainer.slicer.link.link_status import LinkState
from rastrainer.slicer.scene.nodes import VOLUME, Role, findNode
from rastrainer_simulator.assets import asset_path
from Testing.domain.igtl.sent_pose import transform_of
from Testing.slicer.host.host import Host
from Testing.slicer.test_views import place

COLIN27 = load_scenario(asset_path("scenarios", "colin27"))
ANSWERS = {"ListTasks": {"scenario": "colin27", "title": "Colin27 head", "tasks": []}}
TARGET = (22.0, 8.0, 14.0)


def images(host):
    return findNode(host.scene, VOLUME, Role.HEAD_VOLUME)


def show_scenario(host):
    """Press the button, and wait for the images, which come a moment later."""
    host.open()
    host.unfold("showScenarioButton")
    host.press("showScenarioButton")
    wait_for_images(host)


def wait_for_images(host):
    host.wait_until(lambda: images(host) and images(host).GetImageData(), "the images are loaded")
    host.finish_work()


def test_the_mri_is_behind_head_and_fiducials_in_each_slice_view(host, tmp_path):
    show_scenario(host)
    node = images(host)
    manager = slicer.app.layoutManager()
    for name in manager.sliceViewNames():
        composite = manager.sliceWidget(name).mrmlSliceCompositeNode()
        assert composite.GetBackgroundVolumeID() == node.GetID()
    np.testing.assert_allclose(place(host.scene), COLIN27.target.position_ras, atol=1e-3)
    host.window_screenshot(tmp_path / "window.png")
    gray, skin = gray_and_skin(tmp_path / "window.png")
    assert gray > 40_000
    assert skin > 300


def gray_and_skin(path):
    """How many pixels of the views are gray as tissue, and how many have the head's color."""
    picture = QtGui.QImage(str(path)).convertToFormat(QtGui.QImage.Format.Format_RGB888)
    rows = np.frombuffer(picture.constBits(), np.uint8).reshape(picture.height(), -1)
    colors = rows[:, : 3 * picture.width()].reshape(picture.height(), -1, 3)[:, 440:].astype(int)
    spread = np.ptp(colors, axis=2)
    brightness = colors.mean(axis=2)
    is_gray = (spread < 4) & (brightness > 30) & (brightness < 225)
    red, green, blue = np.moveaxis(colors, 2, 0)
    is_skin = (red > 150) & (red - green > 20) & (green - blue > 10)
    return np.count_nonzero(is_gray), np.count_nonzero(is_skin)


def test_a_target_is_placed_on_the_mri_and_lies_where_it_was_placed(host):
    show_scenario(host)
    host.unfold("placeTargetButton")
    host.press("placeTargetButton")
    host.place(*TARGET)
    node = host.find("planComboBox").currentNode()
    np.testing.assert_allclose(node.GetNthControlPointPosition(0), TARGET)
    volume = imageOfNode(images(host))
    i, j, k = np.rint(np.linalg.inv(volume.ijkToRas) @ [*TARGET, 1.0])[:3].astype(int)
    assert 40 < volume.values[i, j, k] < 200


def test_the_button_restores_the_mri_if_others_are_shown_or_the_scene_was_cleared(host):
    show_scenario(host)
    other = host.scene.AddNewNodeByClass(VOLUME, "Another MRI")
    slicer.util.setSliceViewerLayers(background=other)
    host.press("showScenarioButton")
    host.finish_work()
    composite = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceCompositeNode()
    assert composite.GetBackgroundVolumeID() == images(host).GetID()
    host.clear_scene()
    assert images(host) is None
    host.press("showScenarioButton")
    wait_for_images(host)
    # It is not offered as a scan to make a scenario of.
    host.unfold("scanComboBox")
    assert host.find("scanComboBox").currentNode() is None


def test_unusable_images_are_reported_with_the_scenario(host):
    folder = user_library() / "broken"
    shutil.copytree(COLIN27.folder, folder)
    content = json.loads((folder / "scenario.json").read_text(encoding="utf-8"))
    content |= {"name": "broken", "title": "Broken images"}
    (folder / "scenario.json").write_text(json.dumps(content), encoding="utf-8")
    (folder / "volume.nrrd").write_bytes(b"no image")
    host.open()
    host.unfold("showScenarioButton")
    host.choose("scenarioComboBox", "Broken images")
    host.press("showScenarioButton")
    text = "There are no images in the slice views: "
    host.wait_until(lambda: text in host.text("scenarioText"), "the problem is shown")
    assert "volume.nrrd must start as NRRD files do" in host.text("scenarioText")
    assert images(host) is None
    assert host.messages == []


def test_a_scene_cleared_as_soon_as_the_mri_is_loaded_gets_it_again(host):
    host.open()
    host.unfold("showScenarioButton")
    session, cleared = host.widget.logic.session, []

    def clear_and_show_again(_node):
        if not cleared:
            cleared.append(True)
            host.scene.Clear(0)
            session.scenario.show("colin27", session.task)

    session.files.shown.connect(clear_and_show_again)
    host.press("showScenarioButton")
    host.wait_until(lambda: cleared, "the scene is cleared")
    wait_for_images(host)


def test_without_a_main_window_the_mri_is_still_in_the_scene(tmp_path):
    host = Host(tmp_path / "slicer", window=False)
    try:
        show_scenario(host)
        assert host.errors == []
    finally:
        host.close()


@pytest.fixture
def trial(host, simulator):
    """The module connected to a simulator that plays a trial of task 1 on the default head."""
    simulator.responder = lambda name, _arguments: ANSWERS.get(name, {})
    host.open()
    host.unfold("portSpinBox")
    host.type("portSpinBox", str(simulator.port))
    host.press("connectButton")
    simulator.send(DeviceName.SIM_SERVER, Status(Status.OK, subcode=PROTOCOL_VERSION))
    link = host.widget.logic.session.link
    host.wait_until(lambda: link.status.state is LinkState.CONNECTED, "it is connected")
    trial = Trial(host, simulator)
    trial.tell(nextPoint="1")
    wait_for_images(host)
    return trial


class Trial:
    def __init__(self, host, simulator):
        self._host = host
        self._simulator = simulator
        self._id = str(uuid.UUID(int=7))

    def tell(self, **state):
        values = {"trialId": self._id, "phase": "running", "task": "task-1", "trainee": "T-001"}
        self._simulator.send(DeviceName.SIM_STATE, String(json.dumps({**values, **state})))

    def wait_for_slices_at(self, wanted):
        self._host.wait_until(
            lambda: np.allclose(place(self._host.scene), wanted, atol=1e-2), "the slices are there"
        )

    def requests(self):
        """Whether poses were requested, in each of the greetings."""
        hellos = [sent for name, sent in self._simulator.commands if name == "Hello"]
        return [hello["toolTipHz"] > 0 for hello in hellos]


def test_the_slices_move_to_each_next_point_of_a_trial_unless_unchecked(host, trial):
    fiducials = COLIN27.task("task-1").fiducials
    trial.wait_for_slices_at(fiducials[0])
    trial.tell(nextPoint="2")
    trial.wait_for_slices_at(fiducials[1])
    host.unfold("slicesNextPointCheckBox")
    host.check("slicesNextPointCheckBox", False)
    trial.tell(nextPoint="3")
    host.wait_until(lambda: host.text("nextPointText") == "3", "the next point is shown")
    host.idle_for(0.3)
    trial.wait_for_slices_at(fiducials[1])
    host.check("slicesNextPointCheckBox")
    trial.wait_for_slices_at(fiducials[2])


def test_following_the_tool_with_the_slices_makes_the_module_request_poses(host, trial, simulator):
    assert not any(trial.requests())
    host.unfold("slicesToolCheckBox")
    host.check("slicesToolCheckBox")
    host.wait_until(lambda: trial.requests()[-1], "poses are requested")
    for place_ras in ((10.0, 70.0, 60.0), (-30.0, 20.0, 80.0)):
        world = transforms.apply(COLIN27.head_to_world, place_ras)
        pose = transforms.rigid(np.eye(3), world)
        simulator.send(DeviceName.TOOL_TIP_TO_WORLD, transform_of(pose))
        trial.wait_for_slices_at(place_ras)
    host.check("slicesToolCheckBox", False)
    host.wait_until(lambda: not trial.requests()[-1], "poses are no longer requested")
    trial.wait_for_slices_at(COLIN27.task("task-1").fiducials[0])
