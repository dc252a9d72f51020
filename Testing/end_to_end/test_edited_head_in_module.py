"""A head is found, edited and made into a scenario in the module; Cancel leaves nothing."""

from __future__ import annotations

import functools
import threading

import numpy as np
import pytest
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.library import user_library
from rastrainer.scenario.points import LABELS
from rastrainer.sections import new_scenario_logic
from rastrainer.slicer.head.volume import SEGMENT_NAME
from rastrainer.slicer.scene.nodes import Role, setPoints
from Testing.end_to_end.module.story import Story, unfold
from Testing.running_process import runs
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.placed import add_volume, fiducials
from Testing.slicer.host.cancels import cancels
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)

SIZE = 0.75
WEN, WEN_RADIUS = np.array([0.0, -55.0, 0.0]), 12.0
"""Center of the paint at the back of the head, RAS mm."""


@functools.cache
def scanned():
    """Return the scan of a head, which no test changes."""
    return phantom(spacing=(2.0, 2.0, 2.0), size=SIZE)


@pytest.fixture(autouse=True)
def _scan_is_chosen(host, tmp_path):
    """A scan is chosen, with fiducials placed by hand and a program that plans on it."""
    Story(host, tmp_path).choose_own_program()
    unfold(host, "newScenarioCollapsibleButton")
    unfold(host, "adjustHeadGroupBox")
    unfold(host, "planForScenarioGroupBox")
    placed = host.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "By hand")
    setPoints(placed, LABELS, fiducials(SIZE))
    host.check("handPlacedCheckBox")
    host.check("skullCheckBox", False)
    host.choose("scanComboBox", add_volume(host.scene, scanned(), "Ms X"))


def paint_wen(node):
    """Paint a ball into the segment as the Segment Editor does: on the grid of the scan."""
    scan = scanned()
    ijk = np.indices(scan.values.shape).reshape(3, -1).T
    ras = ijk @ scan.ijkToRas[:3, :3].T + scan.ijkToRas[:3, 3]
    ball = (np.linalg.norm(ras - WEN, axis=1) < WEN_RADIUS).reshape(scan.values.shape)
    image = slicer.vtkOrientedImageData()
    image.SetDimensions(ball.shape)
    image.SetImageToWorldMatrix(slicer.util.vtkMatrixFromArray(scan.ijkToRas))
    values = np.ascontiguousarray(ball.transpose(2, 1, 0), np.uint8).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(values, array_type=vtk.VTK_UNSIGNED_CHAR, deep=1))
    logic = slicer.vtkSlicerSegmentationsModuleLogic
    segment = node.GetSegmentation().GetSegmentIdBySegmentName(SEGMENT_NAME)
    assert logic.SetBinaryLabelmapToSegment(image, node, segment, logic.MODE_MERGE_MAX)


@pytest.mark.soak
def test_the_scenario_has_the_edited_head_on_the_base_that_was_shown(host):
    host.press("previewHeadButton")
    assert host.messages == []
    shown = Role.HEAD_PREVIEW.find(host.scene).GetPolyData().GetBounds()
    paint_wen(Role.HEAD_SEGMENT.find(host.scene))
    host.press("makeScenarioButton")
    assert host.messages == []
    made = read_head_mesh(user_library() / "ms-x" / "head.ply").vertices
    assert made[:, 2].min() == pytest.approx(shown[4], abs=0.51)
    assert made[:, 2].max() == pytest.approx(shown[5], abs=1.0)
    assert shown[2] == pytest.approx(-76.0 * SIZE, abs=1.5)
    assert made[:, 1].min() == pytest.approx(WEN[1] - WEN_RADIUS, abs=1.5)


def test_a_scenario_canceled_while_its_head_is_extracted_or_planned_on_leaves_nothing_behind(
    host, tmp_path, monkeypatch
):
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
