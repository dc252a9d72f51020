"""The published state: how often in simulated time, and in millimeters."""

import json
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.igtl.content import Points
from rastrainer.igtl.message import HEADER_BYTES, read_header, unpack
from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import DeviceName, Phase, Proximity
from rastrainer_simulator import trial_state
from rastrainer_simulator.net.igtl.publisher import PoseSubscription, Publisher
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.trial_state import TouchState
from Testing.simulator.net.igtl.servers import at_rest

TICK_S = 0.004
RUNNING = TrainingState(1, Phase.RUNNING, "anna", "task-1", "desktop", "id-1", "1", "Touch 1.")
FIRST = TouchState("1", (0.5, -0.25, 0.125), 1.0, 1.0)
SECOND = TouchState("2", (0.4, 0.1, 0.2), 2.0, 2.0)


class Receiver:
    """Stands in for a connection and unpacks its messages."""

    def __init__(self):
        self.messages = []

    def send_latest(self, outgoing):
        data = outgoing.packed(2)
        self.messages.append(unpack(read_header(data), data[HEADER_BYTES:]))

    def of(self, device):
        return [message for message in self.messages if message.device == device]


@pytest.fixture
def receiver() -> Receiver:
    return Receiver()


@pytest.fixture
def publisher(receiver) -> Publisher:
    """A publisher whose only subscriber has the current state."""
    publisher = Publisher(at_rest)
    publisher.subscribe(receiver, PoseSubscription())
    publisher.publish(at_rest())
    receiver.messages.clear()
    return publisher


def run(publisher, seconds, state_at=lambda t: at_rest(sim_time=t), start=1.0):
    for tick in range(round(seconds / TICK_S)):
        state = state_at(start + tick * TICK_S)
        if publisher.is_due(state):
            publisher.publish(state)


def moving(sim_time):
    pose = np.eye(4)
    pose[0, 3] = sim_time
    return at_rest(sim_time=sim_time, tool_tip_to_world=pose, link_to_world=(pose,) * 8)


def test_each_client_gets_the_rates_that_it_requested(publisher, receiver):
    fast, silent = Receiver(), Receiver()
    publisher.subscribe(fast, PoseSubscription(250, 10))
    publisher.subscribe(silent, PoseSubscription(0, 0))
    run(publisher, 4, moving)
    assert len(fast.of("ToolTipToWorld")) == pytest.approx(1000, abs=1)
    assert len(fast.of("Link3ToWorld")) == pytest.approx(40, abs=1)
    assert len(receiver.of("ToolTipToWorld")) == pytest.approx(240, abs=1)
    assert not silent.of("ToolTipToWorld") + silent.of("Link0ToWorld")


def test_at_rest_only_a_steady_client_gets_poses(publisher, receiver):
    steady = Receiver()
    publisher.subscribe(steady, PoseSubscription(is_steady=True))
    run(publisher, 2)
    assert len(steady.of("ToolTipToWorld")) == pytest.approx(120, abs=1)
    assert receiver.messages == []


def test_a_new_subscriber_gets_every_pose_once(publisher):
    late = Receiver()
    for _ in range(2):
        publisher.subscribe(late, PoseSubscription())
        run(publisher, 1)
        counts = Counter(message.device for message in late.messages)
        assert counts.pop("CapturedPoints") == counts.pop("SimState") == 1
        assert counts == dict.fromkeys([*DeviceName.LINK_TO_WORLD, DeviceName.TOOL_TIP_TO_WORLD], 1)
        late.messages.clear()


def test_state_is_ascii_json_with_the_agreed_keys(publisher, receiver):
    state = at_rest(
        sim_time=3.0,
        training=replace(RUNNING, trainee="Zoë"),
        proximity=Proximity.PROXIMITY,
        clearance=0.0123456,
        depth=0.0012345,
        operator="gamepad",
    )
    publisher.publish(state)
    (message,) = receiver.of("SimState")
    assert message.content.text.isascii()
    sent = json.loads(message.content.text)
    assert sent.pop("seq") > 0
    assert sent == {
        "simTimeS": 3.0,
        "elapsedS": state.elapsed,
        "phase": "running",
        "trainee": "Zoë",
        "task": "task-1",
        "mode": "desktop",
        "trialId": "id-1",
        "nextPoint": "1",
        "instruction": "Touch 1.",
        "proximity": "proximity",
        "q": [0.0] * 7,
        "operator": "gamepad",
        "method": "fiducials",
        "trace": None,
        "procedure": None,
    }


def aligning(feed=0.0, phase=Phase.ALIGNING, **others):
    """Return a state in which the guide points down, 3 mm aside of a line straight down."""
    pose = np.array([[1, 0, 0, 0.5], [0, -1, 0, 0.0], [0, 0, -1, 0.4], [0, 0, 0, 1.0]])
    line = trial_state.PlannedLine("Left", (0.503, 0.0, 0.38), (0.503, 0.0, 0.3))
    procedure = trial_state.ProcedureState(
        "dbs",
        stage=phase,
        registration=UsedRegistration((1.0,) * 16, 1.0, 1.0),
        checkpoints=(trial_state.CheckedPoint("Vertex", (0.0, 0.0, 0.0), 0.00123456, 1.0, 1.0),),
        trajectories=(trial_state.TrajectoryState(line), trial_state.TrajectoryState(line)),
    )
    training = replace(RUNNING, phase=phase, procedure=procedure)
    return at_rest(tool_tip_to_world=pose, training=training, feed=feed, **others)


def test_a_procedure_is_reported_by_the_current_registration_in_mm_and_degrees(publisher, receiver):
    publisher.publish(aligning(sim_time=1.0))
    (message,) = receiver.of("SimState")
    assert json.loads(message.content.text)["procedure"] == {
        "name": "dbs",
        "trajectory": 0,
        "trajectories": 2,
        "tool": "guide",
        "registrationInUse": True,
        "entryDistanceMm": 3.0,
        "angleDeg": 0.0,
        "standOffMm": 20.0,
        "feedMm": 0.0,
        "lastCheckMm": 1.235,
    }


def test_the_instruments_tip_is_on_the_guides_axis_at_the_fed_depth(publisher, receiver):
    drilling = aligning(phase=Phase.DRILLING)
    for number, (feed, sent) in enumerate(((0.0125, 1), (0.0125, 1), (0.0135, 2)), start=1):
        publisher.publish(replace(drilling, sim_time=float(number), feed=feed))
        assert len(receiver.of("InstrumentTipToWorld")) == sent
    message = receiver.of("InstrumentTipToWorld")[0]
    np.testing.assert_allclose(np.array(message.content.matrix)[:3, 3], (500, 0, 387.5), atol=1e-4)


def test_points_are_sent_completely_and_immediately_at_every_touch_and_undo(publisher, receiver):
    steps = [(FIRST,), (FIRST, SECOND), (FIRST,), ()]
    for number, touches in enumerate(steps):
        state = at_rest(sim_time=5.0, training=replace(RUNNING, revision=number, touches=touches))
        assert publisher.is_due(state)
        publisher.publish(state)
    lists = [message.content for message in receiver.of("CapturedPoints")]
    labels = [[point.label for point in points.points] for points in lists]
    assert labels == [["1"], ["1", "2"], ["1"], []]
    assert lists[0].points[0].position == (500, -250, 125)


def test_empty_list_carries_the_metadata_that_makes_slicer_clear_its_own(publisher, receiver):
    with_point = replace(RUNNING, touches=(FIRST,))
    publisher.publish(at_rest(sim_time=5.0, training=with_point))
    publisher.publish(at_rest(sim_time=5.1, training=replace(RUNNING, trial_id="id-2")))
    last = receiver.of("CapturedPoints")[-1]
    assert last.content == Points(())
    assert last.metadata == {"count": "0", "trialId": "id-2"}
