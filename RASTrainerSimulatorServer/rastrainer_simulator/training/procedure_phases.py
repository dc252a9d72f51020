"""The phases of a procedure, the commands that lead from one to the next, and their records.

Nothing here knows where the head is. The trainee's picture and sentences follow from their
registration; the true distances at the moment of LockGuide only decide whether the guide may be
locked.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from rastrainer.commands import CommandName
from rastrainer.journal.entries import AcceptedCheckpoint, Rejected
from rastrainer.procedure.record import MAX_ATTEMPTS, MAX_TOUCHED_CHECKPOINTS, UsedRegistration
from rastrainer.protocol import STAND_OFF_LIMIT_MM, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Event, OperatorCommand, TrainingState
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.feed import NO_FEED, Feed, ProcedureSettings
from rastrainer_simulator.training.head_pose import RegisteredPlan
from rastrainer_simulator.training.replies import TrainingReply, TrialStep
from rastrainer_simulator.training.rules import TouchMoment, TrainingSettings
from rastrainer_simulator.trial_state import (
    CheckedPoint,
    GuideAlignment,
    GuideAxis,
    ProcedureState,
    RegistrationAttempt,
    TraceState,
    TrajectoryState,
)
from rastrainer_simulator.vectors import in_millimeters

if TYPE_CHECKING:
    from rastrainer.procedure.plan import Procedure

AT_EACH_STAGE: Mapping[Phase, str] = {
    Phase.ALIGNING: "align",
    Phase.DRILLING: "drill",
    Phase.INSERTING: "insert",
}
"""Instructions when the trial continues there after a pause."""


@dataclass(frozen=True)
class ProcedureMoment:
    """When and where a command of a procedure is carried out, and with which arguments.

    `elapsed` is the trial's time, s.
    """

    state: TrainingState
    now: TouchMoment
    elapsed: float
    arguments: Mapping[str, Any]

    @property
    def procedure(self) -> ProcedureState:
        assert self.state.procedure is not None, "the phase has a procedure"
        return self.state.procedure

    @property
    def trajectory(self) -> TrajectoryState:
        assert self.procedure.present is not None, "the phase has a trajectory"
        return self.procedure.present

    def entering(
        self, phase: Phase, present: TrajectoryState | None = None, **changes: Any
    ) -> TrainingState:
        """Return the state in another phase, with changes of the current trajectory."""
        procedure = self.procedure
        if present is not None:
            procedure = procedure.with_present(present)
        entered = replace(procedure.entering(phase, self.elapsed), **changes)
        return replace(self.state, phase=phase, procedure=entered)

    def attempts(self) -> tuple[RegistrationAttempt, ...]:
        now = self.procedure
        attempt = RegistrationAttempt(self.state.touches, now.registration, now.checkpoints)
        return (*now.attempts, attempt)


class ProcedurePhases:
    """The state machine from Register to the last ReleaseInstrument, of one procedure."""

    def __init__(
        self,
        procedure: Procedure,
        labels: Sequence[str],
        touches: TrainingSettings,
        settings: ProcedureSettings,
    ) -> None:
        """`labels` name the task's fiducials; `touches` are the rules of a touch."""
        self._procedure = procedure
        self._labels = tuple(labels)
        self._touches = touches
        self._settings = settings

    def step(
        self, command: OperatorCommand, state: TrainingState, now: TouchMoment, elapsed: float
    ) -> TrialStep | TrainingReply:
        moment = ProcedureMoment(state, now, elapsed, command.arguments)
        return self.HANDLERS[command.name](self, moment)

    def resumed(self, state: TrainingState) -> TrialStep:
        procedure = state.procedure
        assert procedure is not None
        running = replace(state, phase=procedure.stage)
        if procedure.stage is Phase.VERIFYING:
            if procedure.registration is None:
                return TrialStep(running, "verifying")
            return TrialStep(running, "verify", {"fre": procedure.registration.fre_mm})
        assert procedure.present is not None, "the stage has a trajectory"
        key, values = AT_EACH_STAGE[procedure.stage], {"name": procedure.present.line.name}
        return TrialStep(running, key, values)

    def _verify(self, moment: ProcedureMoment) -> TrialStep:
        data = {"completion_time_s": moment.state.completed_s}
        return TrialStep(moment.entering(Phase.VERIFYING), "verifying", data=data)

    def _use_registration(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        """Show the plan by a registration from now on; a second one is refused unless equal."""
        registration = UsedRegistration.from_arguments(moment.arguments)
        known = moment.procedure.registration
        if known is not None and not known.agrees_with(registration):
            return TrainingReply(False, say("already in use"))
        plan = RegisteredPlan.of(registration.matrix)
        if plan is None:
            return TrainingReply(False, say("not rigid"))
        used = known or registration
        procedure = replace(
            moment.procedure,
            registration=used,
            trajectories=tuple(
                TrajectoryState(plan.line(each)) for each in self._procedure.trajectories
            ),
        )
        state = replace(moment.state, procedure=procedure)
        return TrialStep(state, "verify", {"fre": used.fre_mm}, data={"registration": used})

    def _check_point(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        """Touch the nearest checkpoint; its error is by the trainee's own registration."""
        procedure, now, name, error = moment.procedure, moment.now, "", 0.0
        checkpoints = self._procedure.checkpoints
        plan = None
        if procedure.registration is not None:
            plan = RegisteredPlan.of(procedure.registration.matrix)
        if plan is not None and checkpoints:
            name, error = plan.nearest_checkpoint(checkpoints, now.tip)
        place = {"checkpoint": name, **now.place}
        before = sum(len(each.checkpoints) for each in procedure.attempts)
        radius = self._settings.checkpoint_radius
        sentence = ""
        if procedure.registration is None:
            sentence = say("not in use yet")
        elif not name:
            sentence = say("no checkpoints")
        elif before + len(procedure.checkpoints) >= MAX_TOUCHED_CHECKPOINTS:
            sentence = say("too many checkpoints", most=MAX_TOUCHED_CHECKPOINTS)
        elif error > radius:
            away, within = MM_PER_M * error, MM_PER_M * radius
            sentence = say("too far from checkpoints", name=name, distance=away, radius=within)
        elif self._touches.is_above(now):
            sentence = say("above a checkpoint", height=MM_PER_M * now.tip_clearance)
        if sentence:
            event = Event(now.sim_time, Rejected(**place, message=sentence))
            return TrainingReply(False, sentence, events=(event,))
        checked = CheckedPoint(name, now.tip, error, now.sim_time, moment.elapsed)
        touched = (*procedure.checkpoints, checked)
        state = replace(moment.state, procedure=replace(procedure, checkpoints=touched))
        error_mm = MM_PER_M * error
        entry = AcceptedCheckpoint(**place, error_mm=error_mm, kept=len(touched))
        return TrialStep(state, "checked", {"name": name, "error": error_mm}, entry)

    def _accept(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        procedure = moment.procedure
        if procedure.registration is None:
            return TrainingReply(False, say("not in use yet"))
        state = moment.entering(Phase.ALIGNING, attempts=moment.attempts())
        return TrialStep(state, "align", {"name": procedure.trajectories[0].line.name})

    def _register_again(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        """Touch all points again; earlier touches stay in the record as an attempt."""
        attempts = moment.attempts()
        if len(attempts) >= MAX_ATTEMPTS:
            return TrainingReply(False, say("too many attempts", most=MAX_ATTEMPTS))
        state = moment.entering(
            Phase.RUNNING, registration=None, checkpoints=(), trajectories=(), attempts=attempts
        )
        trace = None if state.trace is None else TraceState()
        again = replace(state, touches=(), next_point=self._labels[0], trace=trace)
        return TrialStep(again, "register again", {"point": self._labels[0]})

    def _lock(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        """Lock the guide where it is, if a drill in it would meet the head."""
        now, limit_mm = moment.now, STAND_OFF_LIMIT_MM
        ahead = now.feed.ahead
        if ahead.skin is None:
            return TrainingReply(False, say("off the head"))
        distance_mm = MM_PER_M * ahead.skin
        if distance_mm > limit_mm:
            return TrainingReply(
                False, say("too far to lock", distance=distance_mm, limit=limit_mm)
            )
        aligned, guide = moment.trajectory, GuideAxis(now.tip, now.direction)
        locked = replace(
            aligned,
            alignments=aligned.alignments + 1,
            guide=guide,
            is_self_aligned=aligned.is_self_aligned
            or GuideAlignment.of(guide, aligned.line).is_exact,
            drill_depth=0.0,
        )
        return TrialStep(
            moment.entering(Phase.DRILLING, locked),
            "drill",
            {"name": locked.line.name},
            data={"position_mm": in_millimeters(now.tip), "direction": now.direction},
            ahead=ahead.recorded(),
            feed=Feed(ahead=ahead),
        )

    def _retract(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        if moment.now.feed.has_cut_bone:
            return TrainingReply(False, say("bone is cut"))
        values = {"name": moment.trajectory.line.name}
        return TrialStep(moment.entering(Phase.ALIGNING), "realign", values, feed=NO_FEED)

    def _start_insertion(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        feed = moment.now.feed
        if feed.drilled <= 0.0:
            return TrainingReply(False, say("nothing drilled"))
        drilled = replace(moment.trajectory, drill_depth=feed.drilled)
        entered, values = moment.entering(Phase.INSERTING, drilled), {"name": drilled.line.name}
        return TrialStep(entered, "insert", values, feed=replace(feed, depth=0.0))

    def _release(self, moment: ProcedureMoment) -> TrialStep | TrainingReply:
        """Leave the instrument where it is; the next line follows, or the end."""
        depth, procedure = moment.now.feed.depth, moment.procedure
        if depth <= 0.0:
            return TrainingReply(False, say("still in the guide"))
        placed = replace(moment.trajectory, instrument_depth=depth)
        following = procedure.trajectory + 1
        if following == len(procedure.trajectories):
            ended = moment.entering(Phase.REGISTERED, placed, ended_s=moment.elapsed)
            return TrialStep(ended, "procedure done", feed=NO_FEED)
        onward = moment.entering(Phase.ALIGNING, placed, trajectory=following)
        values = {"name": procedure.trajectories[following].line.name}
        return TrialStep(onward, "align next", values, feed=NO_FEED)

    HANDLERS: ClassVar[
        Mapping[str, Callable[[ProcedurePhases, ProcedureMoment], TrialStep | TrainingReply]]
    ] = {
        CommandName.REGISTER: _verify,
        CommandName.CAPTURE: _check_point,
        CommandName.USE_REGISTRATION: _use_registration,
        CommandName.ACCEPT_REGISTRATION: _accept,
        CommandName.REGISTER_AGAIN: _register_again,
        CommandName.LOCK_GUIDE: _lock,
        CommandName.RETRACT_DRILL: _retract,
        CommandName.START_INSERTION: _start_insertion,
        CommandName.RELEASE_INSTRUMENT: _release,
    }
