"""A recorded trial as a Sequence: tool, touches, trace and clearance over time."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.journal.recording import ReplayTrack
from rastrainer.motion.trajectory import Trajectory
from rastrainer.number_text import fixed
from rastrainer.slicer.polydata import pointCloud
from rastrainer.slicer.scene.nodes import (
    ROLE_ATTRIBUTE,
    TOUCH_COLOR,
    Role,
    drawAsPoints,
    findNode,
    findOrAddNode,
    nodesOfClass,
)
from rastrainer.slicer.scene.robot_description import ArmChain

SAMPLE_HZ = 10.0
"""Of what is shown; the journal has 50 samples a second."""
TRIAL_ATTRIBUTE = "RASTrainer.trial"
"""On a replay's browser: UUID of the trial."""
STATES_A_SLICE = 50
"""States added to the scene before the application may draw again."""
SAME_ROBOT_MM = 0.01
TOOL_COLOR = (0.2, 0.45, 0.85)
TOOL_LENGTH_MM, TOOL_RADIUS_MM = 120.0, 2.0

_BROWSER, _PLACE, _TOOL, _TIP, _TOUCHES, _TRACE, _CLEARANCE = (
    f"{Role.REPLAY} {part}"
    for part in ("browser", "place", "tool", "tool model", "touches", "trace", "clearance")
)
POINTS_A_STATE = 10
"""Points of a trace that are added each time."""


def showReplay(
    scene: Any,
    name: str,
    track: ReplayTrack,
    chain: ArmChain,
    worldToHead: np.ndarray,
    rest: Callable[[float], None] = lambda _share: None,
) -> Any:
    """Put a trial into the scene as a Sequence, replacing the previous one.

    It uses separate nodes, so that a running simulator does not disturb it. `rest` is called with
    the share of the work done after each slice; it may let the application draw, and may raise to
    cancel: then nothing is left behind. Returns the `vtkMRMLSequenceBrowserNode`, at the first
    sample.
    """
    trajectory = track.trajectory
    # About ten samples a second, the first and the last.
    times = trajectory.times_s
    wanted = np.arange(times[0], times[-1], 1.0 / SAMPLE_HZ)
    rows = np.unique([*np.searchsorted(times, wanted), len(times) - 1])
    isSameLength = chain.axes.any(axis=1).sum() == track.q.shape[1]
    poses = chain.toolToWorld(track.q[rows]) if isSameLength else None
    tips = trajectory.tip_mm[rows]
    if poses is None or np.abs(poses[:, :3, 3] - tips).max() > SAME_ROBOT_MM:
        raise InputError("The trial was recorded with another robot than the one that is here.")
    removeReplay(scene, rest)
    try:
        return _fillScene(scene, name, trajectory, rows, poses, worldToHead, rest)
    except BaseException:
        removeReplay(scene)
        raise


def _fillScene(
    scene: Any,
    name: str,
    trajectory: Trajectory,
    rows: np.ndarray,
    poses: np.ndarray,
    worldToHead: np.ndarray,
    rest: Callable[[float], None],
) -> Any:
    placed = findOrAddNode(scene, "vtkMRMLLinearTransformNode", _PLACE, f"{name}: WorldToHead")
    placed.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(worldToHead))
    tool = findOrAddNode(scene, "vtkMRMLLinearTransformNode", _TOOL, f"{name}: tool")
    tool.SetAndObserveTransformNodeID(placed.GetID())
    rest(0.0)
    _showTool(scene, f"{name}: tool model", tool)
    rest(0.0)
    touches = findOrAddNode(scene, "vtkMRMLMarkupsFiducialNode", _TOUCHES, f"{name}: touches")
    touches.SetLocked(True)
    display = touches.GetDisplayNode()
    display.SetSelectedColor(TOUCH_COLOR)
    display.SetGlyphScale(2.5)
    display.SetTextScale(3.5)
    touches.SetAndObserveTransformNodeID(placed.GetID())
    rest(0.0)
    clearance = findOrAddNode(scene, "vtkMRMLTextNode", _CLEARANCE, f"{name}: clearance")
    browser = findOrAddNode(scene, "vtkMRMLSequenceBrowserNode", _BROWSER, f"Replay of {name}")
    browser.SetIndexDisplayMode(browser.IndexDisplayAsIndexValue)
    browser.SetPlaybackRateFps(SAMPLE_HZ)
    rest(0.0)
    _checkIsThere(placed, tool, touches, clearance, browser)
    times = trajectory.times_s[rows]
    total, done = 2 * len(rows) + len(trajectory.touches) + 1, 0
    shown = [
        (tool, _toolStates(times, poses)),
        (touches, _touchStates(trajectory)),
        (clearance, _clearanceStates(times, trajectory.clearance_mm[rows])),
    ]
    if trajectory.traced:
        trace = findOrAddNode(scene, "vtkMRMLModelNode", _TRACE, f"{name}: trace")
        drawAsPoints(trace)
        trace.SetAndObserveTransformNodeID(placed.GetID())
        shown.append((trace, _traceStates(trajectory)))
        total += 1 + -(-len(trajectory.traced) // POINTS_A_STATE)
    for proxy, states in shown:
        title = f"{proxy.GetName()} sequence"
        sequence = findOrAddNode(scene, "vtkMRMLSequenceNode", f"{Role.REPLAY} {title}", title)
        sequence.SetIndexName("time")
        sequence.SetIndexUnit("s")
        sequence.SetIndexType(sequence.NumericIndex)
        # Saving the states needs units from the scene that contains them.
        sequence.GetSequenceScene().AddNode(slicer.vtkMRMLSelectionNode())
        for time, state in states:
            # The proxy becomes what the state is, with all its attributes.
            state.SetAttribute(ROLE_ATTRIBUTE, proxy.GetAttribute(ROLE_ATTRIBUTE))
            sequence.SetDataNodeAtValue(state, f"{time:.3f}")
            done += 1
            if done % STATES_A_SLICE == 0:
                rest(done / total)
                _checkIsThere(browser, sequence)
        # Notified of both at once, Slicer creates no proxy itself.
        with slicer.util.NodeModify(browser):
            browser.AddSynchronizedSequenceNode(sequence)
            browser.AddProxyNode(proxy, sequence, False)
            browser.SetOverwriteProxyName(sequence, False)
            browser.SetSaveChanges(sequence, False)
    browser.SetSelectedItemNumber(0)
    return browser


def _checkIsThere(*nodes: Any) -> None:
    if any(node.GetScene() is None for node in nodes):
        raise InputError("The scene was changed before the trial could be shown.")


def goTo(scene: Any, timeS: float) -> None:
    """Show the moment of the trial's time in s, as far as a replay is in the scene."""
    browser = findReplay(scene)
    if browser is None:
        return
    sequence = browser.GetMasterSequenceNode()
    times = [float(sequence.GetNthIndexValue(n)) for n in range(sequence.GetNumberOfDataNodes())]
    # Never after that moment, so that the touch being shown has not been made yet.
    browser.SetSelectedItemNumber(max(0, int(np.searchsorted(times, timeS, side="right")) - 1))


def moment(scene: Any) -> tuple[float, str] | None:
    """Return the replay's time in s and what is said about the clearance; None without one."""
    browser = findReplay(scene)
    text = findNode(scene, "vtkMRMLTextNode", _CLEARANCE)
    if browser is None or text is None or browser.GetMasterSequenceNode() is None:
        return None
    if browser.GetSelectedItemNumber() < 0:
        # It is still being put into the scene.
        return None
    value = browser.GetMasterSequenceNode().GetNthIndexValue(browser.GetSelectedItemNumber())
    return float(value or 0.0), text.GetText()


def findReplay(scene: Any) -> Any | None:
    return findNode(scene, "vtkMRMLSequenceBrowserNode", _BROWSER)


def isReplayOf(scene: Any, trialId: str) -> bool:
    browser = findReplay(scene)
    parts = (
        ("vtkMRMLLinearTransformNode", _PLACE),
        ("vtkMRMLLinearTransformNode", _TOOL),
        ("vtkMRMLModelNode", _TIP),
        ("vtkMRMLMarkupsFiducialNode", _TOUCHES),
        ("vtkMRMLTextNode", _CLEARANCE),
    )
    return (
        browser is not None
        and browser.GetAttribute(TRIAL_ATTRIBUTE) == trialId
        and browser.GetMasterSequenceNode() is not None
        and all(findNode(scene, className, part) is not None for className, part in parts)
    )


def removeReplay(scene: Any, rest: Callable[[float], None] = lambda _share: None) -> None:
    """Remove the replay and all its nodes from the scene; `rest` is as of `showReplay`."""
    ours = _nodesOfReplay(scene, "vtkMRMLNode")
    # First what would show each change of the others.
    for node in sorted(ours, key=lambda node: not node.IsA("vtkMRMLSequenceBrowserNode")):
        if node.GetScene() is None:
            continue
        if node.IsA("vtkMRMLDisplayableNode") and node.GetDisplayNode() is not None:
            scene.RemoveNode(node.GetDisplayNode())
        scene.RemoveNode(node)
        if node.IsA("vtkMRMLSequenceNode"):
            for _slice in _slicesOf(node):
                rest(0.0)


def emptyReplay(scene: Any) -> Iterator[None]:
    """Keep the states of the replay that is in the scene, and release them slice by slice.

    To be called before the scene is closed, which would delete thousands of them at once.
    """
    sequences = _nodesOfReplay(scene, "vtkMRMLSequenceNode")
    return itertools.chain.from_iterable(map(_slicesOf, sequences))


def _nodesOfReplay(scene: Any, className: str) -> list[Any]:
    nodes = nodesOfClass(scene, className)
    return [n for n in nodes if (n.GetAttribute(ROLE_ATTRIBUTE) or "").startswith(Role.REPLAY)]


def _slicesOf(sequence: Any) -> Iterator[None]:
    """Remove the states of a sequence in slices: thousands at once would take too long."""
    count = sequence.GetNumberOfDataNodes()
    for index in reversed(range(count)):
        sequence.RemoveDataNodeAtValue(sequence.GetNthIndexValue(index))
        if index % STATES_A_SLICE == 0:
            yield


def _toolStates(times: np.ndarray, poses: np.ndarray) -> Iterator[tuple[float, Any]]:
    for time, pose in zip(times, poses, strict=True):
        state = slicer.vtkMRMLLinearTransformNode()
        state.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(pose))
        yield time, state


def _touchStates(trajectory: Trajectory) -> Iterator[tuple[float, Any]]:
    """Yield the touches made so far, at the start and at each touch."""
    made = trajectory.touches
    for count in range(len(made) + 1):
        state = slicer.vtkMRMLMarkupsFiducialNode()
        state.SetLocked(True)
        for touch in made[:count]:
            state.AddControlPoint(vtk.vtkVector3d(*touch.position_mm), touch.label)
        yield made[count - 1].time_s if count else float(trajectory.times_s[0]), state


def _traceStates(trajectory: Trajectory) -> Iterator[tuple[float, Any]]:
    """Yield what has been traced so far, at the start and after some points each."""
    made = trajectory.traced
    places = np.array([point.position_mm for point in made])
    for count in (*range(0, len(made), POINTS_A_STATE), len(made)):
        state = slicer.vtkMRMLModelNode()
        state.SetAndObservePolyData(pointCloud(places[:count]))
        yield made[count - 1].time_s if count else float(trajectory.times_s[0]), state


def _clearanceStates(times: np.ndarray, clearance: np.ndarray) -> Iterator[tuple[float, Any]]:
    for time, value in zip(times, clearance, strict=True):
        state = slicer.vtkMRMLTextNode()
        state.SetText(f"{fixed(value, 1)} mm")
        yield time, state


def _showTool(scene: Any, name: str, tool: Any) -> None:
    """Show a needle whose tip is the tool's: its shaft lies along −z."""
    line = vtk.vtkLineSource()
    line.SetPoint1(0.0, 0.0, 0.0)
    line.SetPoint2(0.0, 0.0, -TOOL_LENGTH_MM)
    tube = vtk.vtkTubeFilter()
    tube.SetInputConnection(line.GetOutputPort())
    tube.SetRadius(TOOL_RADIUS_MM)
    tube.SetNumberOfSides(16)
    tube.CappingOn()
    tube.Update()
    model = findOrAddNode(scene, "vtkMRMLModelNode", _TIP, name)
    model.SetAndObservePolyData(tube.GetOutput())
    model.GetDisplayNode().SetColor(TOOL_COLOR)
    model.SetAndObserveTransformNodeID(tool.GetID())
