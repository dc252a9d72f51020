"""The MRI of a scenario in Slicer's slice views: to view, to plan on, and to follow a trial."""

import numpy as np
import pytest
import slicer

from rastrainer import transforms
from rastrainer.protocol import DeviceName
from rastrainer.slicer.scene.nodes import Role
from Testing.domain.igtl.sent_pose import transform_of
from Testing.slicer.recorded_trial import COLIN27
from Testing.slicer.test_views import place
from Testing.slicer.told_module import ToldModule

ANSWERS = {"ListTasks": {"scenario": "colin27", "title": "Colin27 head", "tasks": []}}
TARGET = (22.0, 8.0, 14.0)


@pytest.fixture
def host(fresh_module):
    return fresh_module


def images(host):
    return Role.HEAD_VOLUME.find(host.scene)


def show_scenario(host):
    """Press the button, and wait for the images, which come a moment later."""
    host.unfold("showScenarioButton")
    host.press("showScenarioButton")
    wait_for_images(host)


def wait_for_images(host):
    host.wait_until(lambda: images(host) and images(host).GetImageData(), "the images are loaded")
    host.finish_work()


def test_the_mri_is_behind_head_and_fiducials_and_a_target_is_placed_on_it(host):
    show_scenario(host)
    node = images(host)
    manager = slicer.app.layoutManager()
    for name in manager.sliceViewNames():
        composite = manager.sliceWidget(name).mrmlSliceCompositeNode()
        assert composite.GetBackgroundVolumeID() == node.GetID()
    np.testing.assert_allclose(place(host.scene), COLIN27.target.position_ras, atol=1e-3)
    host.press("placeTargetButton")
    host.place(*TARGET)
    target = host.find("planComboBox").currentNode()
    np.testing.assert_allclose(target.GetNthControlPointPosition(0), TARGET)


@pytest.fixture
def trial(host, simulator):
    """The module connected to a simulator that plays a trial of task 1 on the default head."""
    simulator.responder = lambda name, _arguments: ANSWERS.get(name, {})
    trial = Trial(host, simulator)
    trial.tell(nextPoint="1")
    wait_for_images(host)
    return trial


class Trial(ToldModule):
    """Looks at the slices and at the commands."""

    def wait_for_slices_at(self, wanted):
        self.host.wait_until(
            lambda: np.allclose(place(self.host.scene), wanted, atol=1e-2), "the slices are there"
        )

    def requests(self):
        """Whether poses were requested, in each of the greetings."""
        hellos = [sent for name, sent in self.simulator.commands if name == "Hello"]
        return [hello["toolTipHz"] > 0 for hello in hellos]


def test_the_slices_move_to_each_next_point_unless_unchecked_or_follow_the_tool(
    host, trial, simulator
):
    fiducials = COLIN27.task("task-1").fiducials
    trial.wait_for_slices_at(fiducials[0])
    trial.tell(nextPoint="2")
    trial.wait_for_slices_at(fiducials[1])
    host.check("slicesNextPointCheckBox", False)
    trial.tell(nextPoint="3")
    host.wait_until(lambda: host.text("nextPointText") == "3", "the next point is shown")
    host.widget.onTimeout()
    trial.wait_for_slices_at(fiducials[1])
    host.check("slicesNextPointCheckBox")
    trial.wait_for_slices_at(fiducials[2])
    assert not any(trial.requests())
    host.check("slicesToolCheckBox")
    host.wait_until(lambda: trial.requests()[-1], "poses are requested")
    for place_ras in ((10.0, 70.0, 60.0), (-30.0, 20.0, 80.0)):
        world = transforms.apply(COLIN27.head_to_world, place_ras)
        pose = transforms.rigid(np.eye(3), world)
        simulator.send(DeviceName.TOOL_TIP_TO_WORLD, transform_of(pose))
        trial.wait_for_slices_at(place_ras)
    host.check("slicesToolCheckBox", False)
    host.wait_until(lambda: not trial.requests()[-1], "poses are no longer requested")
    trial.wait_for_slices_at(fiducials[2])
