"""Broken volumes in the section New scenario: each gets a sentence and leaves all as it was."""

import numpy as np
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.scenario_library import user_library
from Testing.end_to_end.module.installed_simulator import write_program
from Testing.slicer.head.broken_volumes import HEADLESS, UNUSABLE
from Testing.slicer.head.placed import add_volume


def nodes_of(scene):
    nodes = (scene.GetNthNode(index) for index in range(scene.GetNumberOfNodes()))
    return [(node.GetID(), node.GetName()) for node in nodes]


def test_a_broken_volume_gets_a_sentence_and_leaves_scene_and_library_as_they_were(host, tmp_path):
    host.open()
    program = write_program(tmp_path / "rastrainer", tmp_path / "simulator.pid", [])
    for name in ("setupGroupBox", "newScenarioCollapsibleButton", "adjustHeadGroupBox"):
        host.find(name).collapsed = False
        host.process_events()
    host.type("programPathLineEdit", str(program))
    for name, (volume, sentence) in (UNUSABLE | HEADLESS).items():
        node = add_volume(host.scene, volume, name)
        host.choose("scanComboBox", node)
        before = nodes_of(host.scene)
        for button in ("previewHeadButton", "makeScenarioButton"):
            told = len(host.messages)
            host.press(button)
            assert len(host.messages) == told + 1, (name, button)
            assert sentence in host.messages[-1].text, (name, button)
            assert host.find("makeScenarioButton").enabled
        assert nodes_of(host.scene) == before, name
        values = vtk_to_numpy(node.GetImageData().GetPointData().GetScalars())
        assert np.array_equal(values, volume.values.ravel(order="F"), equal_nan=True)
    assert not user_library().exists()
