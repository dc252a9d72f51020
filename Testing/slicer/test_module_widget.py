"""The unmodified module in the host: what its panels do when a user works with them."""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import slicer

from rastrainer.igtl.content import Status, String
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.settings import HOST
from Testing.slicer.simulator_double import connect_module


@pytest.fixture
def host(fresh_module):
    return fresh_module


@pytest.fixture
def connected(host, simulator):
    connect_module(host, simulator)


@pytest.mark.usefixtures("connected")
def test_one_button_connects_and_disconnects(host, simulator):
    simulator.send(DeviceName.SIM_STATE, String('{"instruction": "Touch point 3."}'))
    host.wait_until(lambda: host.text("trainingText") == "Touch point 3.", "the instruction")
    assert host.text("connectButton") == "Disconnect"
    with pytest.raises(AssertionError, match="Disconnect first"):
        host.press("probeButton")
    host.press("connectButton")
    assert (host.text("connectButton"), host.text("trainingText")) == ("Connect", "")


def test_an_empty_host_is_reported_and_host_and_port_outlive_the_scene(host):
    host.type("hostLineEdit", " ")
    host.press("connectButton")
    assert "Enter the host of the simulator" in host.messages[-1].text
    host.type("hostLineEdit", "10.0.0.7")
    host.type("portSpinBox", "18999")
    host.clear_scene()
    host.leave()
    host.enter()
    assert host.text("hostLineEdit") == "10.0.0.7"
    assert host.find("portSpinBox").value == 18999


@pytest.mark.usefixtures("connected")
def test_the_connection_outlives_a_cleared_scene_and_any_deleted_node(host, simulator):
    host.clear_scene()
    host.wait_until(lambda: len(simulator.commands) > 1, "the module sends its greeting again")
    host.delete_nodes()

    def is_connected_again():
        simulator.send(DeviceName.SIM_SERVER, Status(Status.OK, subcode=PROTOCOL_VERSION))
        return host.text("stateText").startswith("Connected")

    host.wait_until(is_connected_again, "it is connected again")


def test_the_self_tests_pass_and_change_no_setting(host):
    host.type("hostLineEdit", "10.0.0.7")
    before = sorted(slicer.app.settings().allKeys())
    host.run_self_tests()
    assert sorted(slicer.app.settings().allKeys()) == before
    assert slicer.app.settings().value(HOST.key) == "10.0.0.7"


def test_sample_data_are_loaded_into_the_slices_or_reported_and_leave_nothing(host, monkeypatch):
    logic, nodes = slicer.util.getModuleLogic("SampleData"), host.scene.GetNumberOfNodes()
    with monkeypatch.context() as patch:
        patch.setattr(logic, "uri", "http://127.0.0.1:9/sample.nrrd")
        host.press("sampleDataButton")
    assert "Connect this computer to the Internet" in host.messages[-1].text
    assert (logic.attempts, host.scene.GetNumberOfNodes()) == (0, nodes)
    assert host.find("sampleDataButton").enabled
    # Loading may also fail although there is a network.
    with monkeypatch.context() as patch:
        patch.setattr(logic, "downloadSamples", lambda _name: [None])
        host.press("sampleDataButton")
    assert len(host.messages) == 2
    assert "could not be downloaded" in host.messages[-1].text
    red = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceCompositeNode()
    host.press("sampleDataButton")
    volume = host.scene.GetFirstNodeByName("MRBrainTumor1")
    assert red.GetBackgroundVolumeID() == volume.GetID()
    assert host.find("scanComboBox").currentNode() is volume


def test_every_button_box_and_list_is_used_in_a_test():
    """A test contains its name as a string."""
    root = Path(__file__).parents[2]
    names = {
        widget.get("name")
        for path in (root / "RASTrainer" / "Resources" / "UI").glob("*.ui")
        for widget in ElementTree.parse(path).iter("widget")
        if widget.get("class") in ("QPushButton", "QCheckBox", "QComboBox")
    }
    assert len(names) > 60
    tests = [*root.glob("Testing/slicer/test_*.py"), *root.glob("Testing/end_to_end/**/*.py")]
    used = {name for path in tests for name in re.findall(r'"(\w+)"', path.read_text("utf-8"))}
    assert names - used == set()
