"""The state as messages, each device at its rate, packed once for all clients.

Meters become millimeters here and nowhere else.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from rastrainer.igtl.content import Point, Points, String, Transform
from rastrainer.igtl.message import Message
from rastrainer.json_records import record_to_json
from rastrainer.protocol import DeviceName, Rate
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.loop.timing import Pacer
from rastrainer_simulator.net.igtl.outgoing import Outgoing
from rastrainer_simulator.net.igtl.server import ClientConnection
from rastrainer_simulator.state import SimulationState, TrainingState
from rastrainer_simulator.texts.texts import LocalizedText, Texts
from rastrainer_simulator.training.tracing import stroke_entry
from rastrainer_simulator.trial_state import ProcedureState, Tool

_WITHOUT_DISTANCE: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "too far": (
        "Too far from point {point}: a touch counts within {radius:g} mm.",
        ("point", "radius"),
    ),
    "above the skin": ("The tip is above the skin: lower it onto point {point}.", ("point",)),
    "wrong point": (
        "Wrong point: that is point {label}; point {point} is next.",
        ("point", "label"),
    ),
    "above a checkpoint": ("The tip is above the skin: lower it onto the checkpoint.", ()),
    "too far to lock": (
        "The guide's tip is too far from the skin along its axis: lock it within {limit:.0f} mm.",
        ("limit",),
    ),
}
_TOLD = Texts({key: text for key, (text, _values) in _WITHOUT_DISTANCE.items()})
_SAME = {"much too far": "too far"}


def told(sentence: str) -> str:
    """Return a trial's sentence in English, without the distances that the trainee reads.

    They would give the secret pose of the head together with the exact pose of the tip
    (`Testing/security/pose_leak.py`).
    """
    if not isinstance(sentence, LocalizedText):
        return sentence
    key = _SAME.get(sentence.key, sentence.key)
    kept = _WITHOUT_DISTANCE[key][1] if key in _WITHOUT_DISTANCE else tuple(sentence.values)
    return _TOLD.say(key, **{name: sentence.values[name] for name in kept})


def tips(state: SimulationState, seq: int) -> tuple[Message, ...]:
    """Return the poses of the tool's tip and, where one is in the guide, of the instrument's.

    What Slicer cannot read from a header is in the metadata.
    """
    metadata = {"seq": str(seq), "simTimeS": f"{state.sim_time:.6f}", "TransformStatus": "OK"}
    pose = state.tool_tip_to_world
    tip = Message(DeviceName.TOOL_TIP_TO_WORLD, _transform(pose), metadata)
    if state.tool not in (Tool.DRILL, Tool.ELECTRODE):
        return (tip,)
    fed = pose.copy()
    fed[:3, 3] += state.feed * pose[:3, 2]
    instrument = _transform(fed)
    return tip, Message(DeviceName.INSTRUMENT_TIP_TO_WORLD, instrument, {"seq": str(seq)})


def links(state: SimulationState, seq: int) -> tuple[Message, ...]:
    metadata = {"seq": str(seq)}
    return tuple(
        Message(device, _transform(pose), metadata)
        for device, pose in zip(DeviceName.LINK_TO_WORLD, state.link_to_world, strict=True)
    )


def captured_points(training: TrainingState) -> Message:
    """Return the whole list of touched points; its metadata let Slicer clear an empty one."""
    points = tuple(
        Point(touch.label, (MM_PER_M * x, MM_PER_M * y, MM_PER_M * z))
        for touch in training.touches
        for x, y, z in [touch.position]
    )
    metadata = {"count": str(len(points)), "trialId": training.trial_id}
    return Message(DeviceName.CAPTURED_POINTS, Points(points), metadata)


def what_changes(state: SimulationState, is_guided: bool = False) -> dict[str, Any]:
    """Return `SimState` without its number and time; it is sent when this changes.

    No distance to the head goes to clients: with the pose of the tip it would be a range finder,
    which gives the head's secret pose (`Testing/security/pose_leak.py`).
    """
    training, trace = state.training, state.training.trace
    return {
        "phase": training.phase.value,
        "trainee": training.trainee,
        "task": training.task,
        "mode": training.mode,
        "trialId": training.trial_id,
        "nextPoint": training.next_point,
        "instruction": told(training.instruction),
        "proximity": state.proximity.value,
        "q": [_rounded(angle, 6) for angle in state.q],
        "operator": state.operator,
        "method": training.method.value,
        "trace": trace and {**record_to_json(stroke_entry(trace)), "isGuided": is_guided},
        "procedure": None if training.procedure is None else _procedure(state, training.procedure),
    }


def _procedure(state: SimulationState, procedure: ProcedureState) -> dict[str, Any]:
    """Return the progress of a procedure: everything by the registration in use, mm and degrees."""
    alignment = state.alignment
    checked = procedure.checkpoints[-1:]
    return {
        "name": procedure.name,
        "trajectory": procedure.trajectory,
        "trajectories": len(procedure.trajectories),
        "tool": procedure.tool.value,
        "registrationInUse": procedure.registration is not None,
        "entryDistanceMm": alignment and _rounded(MM_PER_M * alignment.entry_distance, 3),
        "angleDeg": alignment and _rounded(math.degrees(alignment.angle), 3),
        "standOffMm": alignment and _rounded(MM_PER_M * alignment.stand_off, 3),
        "feedMm": _rounded(MM_PER_M * state.feed, 3),
        "lastCheckMm": _rounded(MM_PER_M * checked[0].error, 3) if checked else None,
    }


def sim_state(changing: Mapping[str, Any], state: SimulationState, seq: int) -> Message:
    """Return `what_changes` with number and times as text: ASCII JSON."""
    times = {"simTimeS": round(state.sim_time, 6), "elapsedS": round(state.completion_time, 3)}
    text = json.dumps({"seq": seq, **times, **changing}, allow_nan=False)
    return Message(DeviceName.SIM_STATE, String(text))


def _transform(pose: np.ndarray) -> Transform:
    *axes, x, y, z = pose[:3].T.ravel().tolist()
    return Transform((*axes, MM_PER_M * x, MM_PER_M * y, MM_PER_M * z))


def _rounded(value: float, digits: int) -> float | None:
    return round(value, digits) if math.isfinite(value) else None


class PoseSubscription:
    """One client's subscription; a new one has received no pose."""

    def __init__(
        self,
        tool_tip_hz: float = Rate.TOOL_TIP_HZ,
        links_hz: float = Rate.LINKS_HZ,
        is_steady: bool = False,
    ):
        """`is_steady` also wants poses that have not changed."""
        self.tool_tip = Pacer(tool_tip_hz)
        self.links = Pacer(links_hz)
        self.is_steady = is_steady
        self.sent: dict[str, bytes] = {}
        """The content of each device's last pose, as sent with 32 bits."""


class Publisher:
    """Sends the simulation's state to its subscribers, at rates of simulated time.

    While nothing changes nothing is sent: for Slicer each pose, even the same again, is a reason to
    render all its views. `is_due` may be called in the control loop's thread; everything else
    belongs to the event loop's.
    """

    def __init__(self, latest: Callable[[], SimulationState]):
        """`latest` returns the newest state, for clients that subscribe between publications."""
        self.is_guided: Callable[[], bool] = lambda: False
        """Says whether a trainee who traces the skin is shown where to draw next."""
        self._latest = latest
        self._poses: dict[ClientConnection, PoseSubscription] = {}
        self._state = Pacer(Rate.STATE_HZ)
        self._number = 0
        self._sent_state: dict[str, Any] = {}
        self._sent_training: TrainingState | None = None
        self._next = math.inf

    def subscribe(self, connection: ClientConnection, poses: PoseSubscription) -> None:
        """Send a client the present state, and changes from now on; call again for other rates."""
        self._poses[connection] = poses
        state = self._latest()
        self._send([connection], captured_points(state.training))
        changing = what_changes(state, self.is_guided())
        self._number += 1
        self._send([connection], sim_state(changing, state, self._number))
        self._next = -math.inf

    def unsubscribe(self, connection: ClientConnection) -> None:
        self._poses.pop(connection, None)

    def is_due(self, state: SimulationState) -> bool:
        """Return whether `publish` would have anything to do."""
        is_news = state.training is not self._sent_training
        return bool(self._poses) and (is_news or state.sim_time >= self._next)

    def publish(self, state: SimulationState) -> None:
        """Send each client the devices that are due and have changed."""
        now = state.sim_time
        sent, training = self._sent_training, state.training
        if training is not sent:
            # Touched points: whenever one was touched or undone, and with a new trial.
            self._sent_training = training
            shown = (training.touches, training.trial_id)
            if sent is None or (sent.touches, sent.trial_id) != shown:
                self._send(self._poses, captured_points(training))
        if self._state.is_due(now):
            changing = what_changes(state, self.is_guided())
            if changing != self._sent_state:
                self._sent_state = changing
                self._number += 1
                self._send(self._poses, sim_state(changing, state, self._number))
        tip_due = [client for client, poses in self._poses.items() if poses.tool_tip.is_due(now)]
        if tip_due:
            self._publish_poses(tip_due, tips(state, self._number + 1))
        links_due = [client for client, poses in self._poses.items() if poses.links.is_due(now)]
        if links_due:
            self._publish_poses(links_due, links(state, self._number + 1))
        due = (min(each.tool_tip.next, each.links.next) for each in self._poses.values())
        self._next = min([self._state.next, *due])

    def _publish_poses(self, due: Iterable[ClientConnection], messages: Iterable[Message]) -> None:
        """Send each client the messages that are new to it; they carry the next number."""
        is_sent = False
        for message in messages:
            content = message.content.pack()
            receivers = []
            for client in due:
                poses = self._poses[client]
                if poses.is_steady or poses.sent.get(message.device) != content:
                    poses.sent[message.device] = content
                    receivers.append(client)
            self._send(receivers, message)
            is_sent = is_sent or bool(receivers)
        if is_sent:
            self._number += 1

    def _send(self, receivers: Iterable[ClientConnection], message: Message) -> None:
        outgoing = Outgoing(message)
        for connection in receivers:
            connection.send_latest(outgoing)
