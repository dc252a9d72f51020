"""A trial without a robot: the tip, the guide and the feed are put wherever they are wanted."""

from dataclasses import replace

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.procedure.plan import Checkpoint, Procedure, ProcedureKind, ProcedureTrajectory
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import OperatorCommand
from rastrainer_simulator.training.feed import NO_FEED, Feed, HeadAhead
from rastrainer_simulator.training.rules import NAMING_A_TRIAL, TouchMoment
from rastrainer_simulator.training.training import Training

ANY_MATRIX = tuple(float(v) for v in np.eye(4).ravel())
REGISTRATION = {"matrix": ANY_MATRIX, "freMm": 1.2, "expectedTreMm": 0.9}
SCORE = {"score": 81.0, "details": {}}
DOWN = (0.0, 0.0, -1.0)
AHEAD = HeadAhead(skin=0.02, outer=0.027, inner=0.034)
LOCKABLE = Feed(ahead=AHEAD)
DRILLED = Feed(depth=0.036, drilled=0.036, ahead=AHEAD)
VERTEX = np.array([0.0, -15.0, 88.0])
PROCEDURE = Procedure(
    name="dbs",
    title="DBS",
    kind=ProcedureKind.DBS,
    source="made up",
    trajectories=(
        ProcedureTrajectory(
            "Left", np.array([-25.0, 30.0, 75.0]), np.array([-12.0, -13.0, -5.0]), 1.3, 2.0
        ),
        ProcedureTrajectory(
            "Right", np.array([25.0, 30.0, 75.0]), np.array([12.0, -13.0, -5.0]), 1.3, 2.0
        ),
    ),
    checkpoints=(
        Checkpoint("Nasion", np.array([0.0, 95.0, -10.0])),
        Checkpoint("Vertex", VERTEX),
    ),
)
PLAIN = replace(PROCEDURE, name="plain", checkpoints=())


class Trial:
    """A trial driven by hand."""

    def __init__(self, scenario, seed=5, **others):
        planned = replace(scenario, procedures=(PROCEDURE, PLAIN))
        self.training = Training(planned, seed, **others)
        self.now = 10.0

    def do(self, name, tip=(0.0, 0.0, 0.0), above_mm=0.0, feed=None, direction=DOWN, **arguments):
        command = OperatorCommand(name, arguments)
        if name in NAMING_A_TRIAL:
            trial_id = self.state.trial_id
            command = OperatorCommand(name, {"trialId": trial_id, **arguments})
        height, feed = above_mm / MM_PER_M, feed or NO_FEED
        moment = TouchMoment(self.now, tip, height, direction=direction, feed=feed)
        return self.training.handle(command, moment)

    def at(self, tip, above_mm=0.0, depth_mm=0.0):
        """Have the tip be somewhere at the end of a tick; return the events of a trace."""
        height, depth = above_mm / MM_PER_M, depth_mm / MM_PER_M
        return self.training.trace(TouchMoment(self.now, tip, height, depth))

    def must(self, name, *places, **arguments):
        reply = self.do(name, *places, **arguments)
        assert reply.ok, reply.message
        return reply

    def start(self, task="task-1", **others):
        return self.do(CommandName.START_TASK, task=task, trainee="P01", mode="desktop", **others)

    def fiducial(self, label):
        return self.place(self.training.truth.fiducials_ras[label])

    def place(self, point):
        """Return a point of the head, RAS mm, where it truly is, World, m."""
        return tuple((self.training.truth.in_world(np.asarray(point)) / MM_PER_M).tolist())

    def touch(self, count=1):
        for _ in range(count):
            reply = self.must(CommandName.CAPTURE, self.fiducial(self.state.next_point))
        return reply

    def exact_registration(self, shift_mm=(0.0, 0.0, 0.0)):
        """Return the true registration, off by a shift in the head's frame."""
        matrix = np.linalg.inv(self.training.truth.head_to_world)
        matrix[:3, 3] += shift_mm
        return {**REGISTRATION, "matrix": tuple(matrix.ravel().tolist())}

    @property
    def state(self):
        return self.training.state

    @property
    def procedure(self):
        return self.training.state.procedure


def at_procedure(scenario, phase, procedure="dbs", shift_mm=(0.0, 0.0, 0.0)):
    """Return a trial that stands in a phase of a procedure, 1 s in each phase before it."""
    trial = Trial(scenario)
    trial.start(procedure=procedure)
    trial.touch(15)
    trial.now += 1.0
    trial.must(CommandName.REGISTER)
    trial.must(CommandName.USE_REGISTRATION, **trial.exact_registration(shift_mm))
    steps = (
        (Phase.VERIFYING, CommandName.ACCEPT_REGISTRATION, None),
        (Phase.ALIGNING, CommandName.LOCK_GUIDE, LOCKABLE),
        (Phase.DRILLING, CommandName.START_INSERTION, DRILLED),
    )
    for stage, command, feed in steps:
        if phase is stage:
            break
        trial.now += 1.0
        trial.must(command, (0.5, 0.0, 0.4), feed=feed)
    assert trial.state.phase is phase
    return trial
