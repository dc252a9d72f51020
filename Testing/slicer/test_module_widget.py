"""The unmodified module in the host: what its panels do when a user works with them."""

import ast
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


def test_a_trajectory_is_placed_by_two_clicks(host):
    host.find("planCollapsibleButton").collapsed = False
    host.process_events()
    host.press("placeTrajectoryButton")
    host.place(0.0, 0.0, 90.0)
    host.place(0.0, 0.0, 30.0)
    with pytest.raises(AssertionError, match="places no points"):
        host.place(0.0, 0.0, 0.0)
    line = host.find("planComboBox").currentNode()
    assert line.GetNumberOfControlPoints() == 2


def test_without_a_network_sample_data_are_reported_and_leave_nothing(host, monkeypatch):
    logic, nodes = slicer.util.getModuleLogic("SampleData"), host.scene.GetNumberOfNodes()
    usual = logic.uri
    for uri in ("http://127.0.0.1:9/sample.nrrd", "file:///nowhere/sample.nrrd"):
        logic.uri = uri
        host.press("sampleDataButton")
        assert "Connect this computer to the Internet" in host.messages[-1].text
        assert logic.attempts == 0
        assert host.scene.GetNumberOfNodes() == nodes
        assert host.text("makeScenarioButton") == "Make scenario"
        assert host.find("sampleDataButton").enabled
    assert len(host.messages) == 2
    # Nor may a sample be loaded though there is a network.
    logic.uri = usual
    monkeypatch.setattr(logic, "downloadSamples", lambda _name: [None])
    host.press("sampleDataButton")
    assert len(host.messages) == 3
    assert "could not be downloaded" in host.messages[-1].text


def test_sample_data_are_loaded_into_the_scene_and_the_slices(host):
    host.find("newScenarioCollapsibleButton").collapsed = False
    host.process_events()
    red = slicer.app.layoutManager().sliceWidget("Red").mrmlSliceCompositeNode()
    host.press("sampleDataButton")
    volume = host.scene.GetFirstNodeByName("MRBrainTumor1")
    assert red.GetBackgroundVolumeID() == volume.GetID()
    assert host.find("scanComboBox").currentNode() is volume


ACTIONS = {"press", "press_slowly", "choose", "check", "click"}
"""Actions of a user; reading a widget's text, or whether it is enabled, is none."""


def used_by(path):
    """Yield the names of the widgets that a test uses, one by one or from a list of names."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in ACTIONS:
            parts = node.args
        elif isinstance(node, (ast.Tuple, ast.List)):
            parts = node.elts
        elif isinstance(node, ast.Dict):
            parts = node.keys
        else:
            continue
        yield from (part.value for part in parts if isinstance(part, ast.Constant))


def widgets_of(*kinds):
    """Return the names of the module's widgets of these kinds."""
    folder = Path(__file__).parents[2] / "RASTrainer" / "Resources" / "UI"
    return {
        widget.get("name")
        for path in folder.glob("*.ui")
        for widget in ElementTree.parse(path).iter("widget")
        if widget.get("class") in kinds
    }


def test_every_button_box_and_list_is_used_in_a_test():
    folder = Path(__file__).parents[1]
    tests = [*(folder / "slicer").glob("test_*.py"), *(folder / "end_to_end").rglob("*.py")]
    used = {name for path in tests for name in used_by(path)}
    names = widgets_of("QPushButton", "QCheckBox", "QComboBox")
    assert len(names) > 60
    assert names - used == set()
