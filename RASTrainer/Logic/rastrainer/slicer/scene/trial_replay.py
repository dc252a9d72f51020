"""A recorded trial as a Sequence: tool, touches, trace and clearance over time."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from typing import Any

import numpy as np
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.journal.recording import ReplayTrack
from rastrainer.number_text import fixed
from rastrainer.slicer.polydata import pointCloud
from rastrainer.slicer.scene import nodes
from rastrainer.slicer.scene.nodes import NodeKind
from rastrainer.slicer.scene.robot_description import OTHER_ROBOT

BROWSER, SEQUENCE = "vtkMRMLSequenceBrowserNode", "vtkMRMLSequenceNode"
SAMPLE_HZ = 10.0
"""Displayed samples a second; the journal has 50."""
TRIAL_ATTRIBUTE = "RASTrainer.trial"
"""On a replay's browser: UUID of the trial."""
STATES_A_SLICE = 50
"""States added to the scene before the application may draw again."""
SAME_ROBOT_MM = 0.01
TOOL_LENGTH_MM, TOOL_RADIUS_MM = 120.0, 2.0

REPLAY = "replay"
_MODE = slicer.vtkMRMLSequenceBrowserNode.IndexDisplayAsIndexValue
_PLAYED = {"IndexDisplayMode": _MODE, "PlaybackRateFps": SAMPLE_HZ}
_BROWSER = NodeKind(BROWSER, f"{REPLAY} browser", values=_PLAYED)
findReplay = _BROWSER.find
"""Returns the `vtkMRMLSequenceBrowserNode` in a scene, or None."""
_PLACE = NodeKind(nodes.TRANSFORM, f"{REPLAY} WorldToHead")
_TOOL = NodeKind(nodes.TRANSFORM, f"{REPLAY} tool")
_TIP = NodeKind(nodes.MODEL, f"{REPLAY} tool model", look={"Color": (0.2, 0.45, 0.85)})
_TOUCHES = NodeKind(nodes.LIST, f"{REPLAY} touches", "", nodes.TOUCH_LOOK, nodes.LOCKED)
_TRACE = NodeKind(nodes.MODEL, f"{REPLAY} trace", "", nodes.TRACE_LOOK, nodes.UNSELECTABLE)
_CLEARANCE = NodeKind(nodes.TEXT, f"{REPLAY} clearance")
POINTS_A_STATE = 10
"""Points of a trace that are added each time."""


def showReplay(
    scene: Any,
    name: str,
    track: ReplayTrack,
    poses: np.ndarray,
    worldToHead: np.ndarray,
    rest: Callable[[float], None] = lambda _share: None,
) -> Any:
    """Put a trial into the scene as a Sequence, replacing the previous one.

    `poses` (n, 4, 4) float, mm, are the tool's poses at the samples of the track.

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
    poses = poses[rows]
    if np.abs(poses[:, :3, 3] - trajectory.tip_mm[rows]).max() > SAME_ROBOT_MM:
        raise InputError(OTHER_ROBOT)
    removeReplay(scene, rest)

    def add(kind: NodeKind, under: Any | None = None) -> Any:
        rest(0.0)
        node = kind.make(scene, f"{name}: {kind.role.removeprefix(f'{REPLAY} ')}")
        if under is not None and node.IsA("vtkMRMLTransformableNode"):
            node.SetAndObserveTransformNodeID(under.GetID())
        return node

    parts = _partsOf(track, rows, poses)
    with ExitStack() as undoing:
        undoing.callback(removeReplay, scene)
        placed = add(_PLACE)
        placed.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(worldToHead))
        proxies = [add(kind, placed) for kind, _times, _setState in parts]
        add(_TIP, proxies[0]).SetAndObservePolyData(_needle())
        browser = _BROWSER.make(scene, f"Replay of {name}")
        rest(0.0)
        _checkIsThere(placed, browser, *proxies)
        total, done = sum(len(times) for _kind, times, _setState in parts), 0
        for proxy, (_kind, moments, setState) in zip(proxies, parts, strict=True):
            title = f"{proxy.GetName()} sequence"
            sequence = NodeKind(SEQUENCE, f"{REPLAY} {title}", title).make(scene)
            nodes.setValues(
                sequence, IndexName="time", IndexUnit="s", IndexType=sequence.NumericIndex
            )
            # Saving the states needs units from the scene that contains them.
            sequence.GetSequenceScene().AddNode(slicer.vtkMRMLSelectionNode())
            for number, time in enumerate(moments):
                # The proxy becomes what the state is, with all its attributes.
                state = getattr(slicer, proxy.GetClassName())()
                setState(state, number)
                state.SetAttribute(nodes.ROLE_ATTRIBUTE, proxy.GetAttribute(nodes.ROLE_ATTRIBUTE))
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
        undoing.pop_all()
    return browser


def _partsOf(
    track: ReplayTrack, rows: np.ndarray, poses: np.ndarray
) -> list[tuple[NodeKind, Sequence[float], Callable[[Any, int], object]]]:
    """Return the moving parts, each with the times of its states, and what sets one of them."""
    trajectory = track.trajectory
    times, clearances = trajectory.times_s[rows], trajectory.clearance_mm[rows]
    made, traced, start = trajectory.touches, trajectory.traced, float(trajectory.times_s[0])
    counts = [*range(0, len(traced), POINTS_A_STATE), len(traced)]

    def setPose(state: Any, row: int) -> None:
        state.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(poses[row]))

    def setTouches(state: Any, count: int) -> None:
        labels = [each.label for each in made[:count]]
        nodes.setPoints(
            nodes.setValues(state, Locked=True), labels, [each.position_mm for each in made[:count]]
        )

    def setTrace(state: Any, number: int) -> None:
        places = [point.position_mm for point in traced[: counts[number]]]
        state.SetAndObservePolyData(pointCloud(np.reshape(places, (-1, 3))))

    def setClearance(state: Any, row: int) -> None:
        state.SetText(f"{fixed(clearances[row], 1)} mm")

    trace = _TRACE, [start, *(traced[count - 1].time_s for count in counts[1:])], setTrace
    return [
        (_TOOL, times, setPose),
        (_TOUCHES, [start, *(each.time_s for each in made)], setTouches),
        (_CLEARANCE, times, setClearance),
        *([trace] if traced else []),
    ]


def _checkIsThere(*parts: Any) -> None:
    if any(part.GetScene() is None for part in parts):
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
    """Return the replay's time in s and its text about the clearance; None without a replay."""
    browser = findReplay(scene)
    text = _CLEARANCE.find(scene)
    if browser is None or text is None or browser.GetMasterSequenceNode() is None:
        return None
    if browser.GetSelectedItemNumber() < 0:
        # It is still being put into the scene.
        return None
    value = browser.GetMasterSequenceNode().GetNthIndexValue(browser.GetSelectedItemNumber())
    return float(value or 0.0), text.GetText()


def isReplayOf(scene: Any, trialId: str) -> bool:
    browser = findReplay(scene)
    return (
        browser is not None
        and browser.GetAttribute(TRIAL_ATTRIBUTE) == trialId
        and browser.GetMasterSequenceNode() is not None
        and all(part.find(scene) for part in (_PLACE, _TOOL, _TIP, _TOUCHES, _CLEARANCE))
    )


def removeReplay(scene: Any, rest: Callable[[float], None] = lambda _share: None) -> None:
    """Remove the replay and all its nodes from the scene; `rest` is as of `showReplay`."""
    ours = _nodesOfReplay(scene, "vtkMRMLNode")
    # First what would show each change of the others.
    for node in sorted(ours, key=lambda node: not node.IsA(BROWSER)):
        if node.GetScene() is None:
            continue
        nodes.removeNode(node)
        if node.IsA(SEQUENCE):
            for _slice in _slicesOf(node):
                rest(0.0)


def emptyReplay(scene: Any) -> Iterator[None]:
    """Keep the states of the replay that is in the scene, and release them slice by slice.

    Call this before the scene is closed: that would delete thousands of states at once.
    """
    return itertools.chain.from_iterable(map(_slicesOf, _nodesOfReplay(scene, SEQUENCE)))


def _nodesOfReplay(scene: Any, className: str) -> list[Any]:
    found = nodes.nodesOfClass(scene, className)
    return [n for n in found if (n.GetAttribute(nodes.ROLE_ATTRIBUTE) or "").startswith(REPLAY)]


def _slicesOf(sequence: Any) -> Iterator[None]:
    """Remove the states of a sequence in slices: thousands at once would take too long."""
    count = sequence.GetNumberOfDataNodes()
    for index in reversed(range(count)):
        sequence.RemoveDataNodeAtValue(sequence.GetNthIndexValue(index))
        if index % STATES_A_SLICE == 0:
            yield


def _needle() -> vtk.vtkPolyData:
    """Return a needle whose tip is the tool's: its shaft lies along −z."""
    line = nodes.setValues(vtk.vtkLineSource(), Point1=(0, 0, 0), Point2=(0, 0, -TOOL_LENGTH_MM))
    tube = nodes.setValues(
        vtk.vtkTubeFilter(), Radius=TOOL_RADIUS_MM, NumberOfSides=16, Capping=True
    )
    nodes.setValues(tube, InputConnection=line.GetOutputPort()).Update()
    return tube.GetOutput()
