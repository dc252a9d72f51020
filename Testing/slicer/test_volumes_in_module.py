"""Broken volumes in the section New scenario: each gets an error and changes nothing."""

import numpy as np
import pytest
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.scenario.library import user_library
from Testing.end_to_end.module.installed_simulator import write_program
from Testing.slicer.head.broken_volumes import HEADLESS, UNUSABLE
from Testing.slicer.head.placed import add_volume


def nodes_of(scene):
    nodes = (scene.GetNthNode(index) for index in range(scene.GetNumberOfNodes()))
    return [(node.GetID(), node.GetName()) for node in nodes]


ALL = UNUSABLE | HEADLESS
BUTTONS = ("previewHeadButton", "makeScenarioButton")


def refuse_each(host, folder, cases):
    """Press the buttons, by the names of the volumes: an error is shown, and nothing changes."""
    host.open()
    program = write_program(folder / "rastrainer", folder / "simulator.pid", [])
    for name in ("setupGroupBox", "newScenarioCollapsibleButton", "adjustHeadGroupBox"):
        host.find(name).collapsed = False
        host.process_events()
    host.type("programPathLineEdit", str(program))
    for name, buttons in cases.items():
        volume, sentence = ALL[name]
        node = add_volume(host.scene, volume, name)
        host.choose("scanComboBox", node)
        before = nodes_of(host.scene)
        for button in buttons:
            count = len(host.messages)
            host.press(button)
            assert len(host.messages) == count + 1, (name, button)
            assert sentence in host.messages[-1].text, (name, button)
            assert host.find("makeScenarioButton").enabled
        assert nodes_of(host.scene) == before, name
        values = vtk_to_numpy(node.GetImageData().GetPointData().GetScalars())
        assert np.array_equal(values, volume.values.ravel(order="F"), equal_nan=True)
    assert not user_library().exists()


def test_a_broken_volume_is_reported_and_leaves_scene_and_library_unchanged(host, tmp_path):
    refuse_each(host, tmp_path, {"2D": BUTTONS[:1], "NaN": BUTTONS[1:], "a block": BUTTONS[:1]})


@pytest.mark.soak
def test_each_broken_volume_is_reported_in_its_own_sentence_at_each_button(host, tmp_path):
    refuse_each(host, tmp_path, dict.fromkeys(ALL, BUTTONS))
