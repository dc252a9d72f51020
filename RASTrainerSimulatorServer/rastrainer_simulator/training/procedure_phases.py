"""The phases of a procedure: which command leads from one to the next, and what it records.

Nothing here knows where the head is. What the trainee sees and reads follows from their
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
from rastrainer.protocol import STAND_OFF_LIMIT_MM, Phase, TouchRule
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import OperatorCommand, TrainingState
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.feed import NO_FEED, Feed, ProcedureSettings
from rastrainer_simulator.training.head_pose import RegisteredPlan
from rastrainer_simulator.training.replies import RefusedStep, TrialStep
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
"""What the trainee reads when the trial continues there after a pause."""


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

    def entering(self, phase: Phase, **changes: Any) -> TrainingState:
        entered = replace(self.procedure.entering(phase, self.elapsed), **changes)
        return replace(self.state, phase=phase, procedure=entered)


class ProcedurePhases:
    """The state machine from Register to the last ReleaseInstrument, of one procedure."""

    def __init__(
        self,
        procedure: Procedure,
        labels: Sequence[str],
        touches: TrainingSettings,
        settings: ProcedureSettings,
    ) -> None:
        """`labels` are those of the task's fiducials; `touches` is what counts as a touch."""
        self._procedure = procedure
        self._labels = tuple(labels)
        self._touches = touches
        self._settings = settings

    def step(
        self, command: OperatorCommand, state: TrainingState, now: TouchMoment, elapsed: float
    ) -> TrialStep | RefusedStep:
        moment = ProcedureMoment(state, now, elapsed, command.arguments)
        return self.HANDLERS[command.name](self, moment)

    def resumed(self, state: TrainingState) -> TrialStep:
        """Return the step by which a paused procedure continues in its stage."""
        procedure = state.procedure
        assert procedure is not None
        running = replace(state, phase=procedure.stage)
        if procedure.stage is Phase.VERIFYING:
            if procedure.registration is None:
                return TrialStep(running, "verifying")
            return TrialStep(running, "verify", {"fre": procedure.registration.fre_mm})
        name = _present(state).line.name
        return TrialStep(running, AT_EACH_STAGE[procedure.stage], {"name": name})

    def _verify(self, moment: ProcedureMoment) -> TrialStep:
        data = {"completion_time_s": moment.state.completed_s}
        return TrialStep(moment.entering(Phase.VERIFYING), "verifying", data=data)

    def _use_registration(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Show the plan by a registration from now on; a second one is refused unless equal."""
        registration = UsedRegistration.from_arguments(moment.arguments)
        known = moment.procedure.registration
        if known is not None and not known.agrees_with(registration):
            return RefusedStep(say("already in use"))
        plan = RegisteredPlan.of(registration.matrix)
        if plan is None:
            return RefusedStep(say("not rigid"))
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

    def _check_point(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Touch the nearest checkpoint; its error is by the trainee's own registration."""
        procedure, now = moment.procedure, moment.now
        name, error = self._nearest_checkpoint(procedure, now)
        place: dict[str, Any] = {
            "checkpoint": name,
            "position_mm": in_millimeters(now.tip),
            "clearance_mm": MM_PER_M * now.tip_clearance,
            "depth_mm": MM_PER_M * now.depth,
        }
        sentence = self._refused_check(procedure, name, error, now)
        if sentence is not None:
            return RefusedStep(sentence, Rejected(**place, message=sentence))
        checked = CheckedPoint(name, now.tip, error, now.sim_time, moment.elapsed)
        checkpoints = (*procedure.checkpoints, checked)
        state = replace(moment.state, procedure=replace(procedure, checkpoints=checkpoints))
        error_mm = MM_PER_M * error
        entry = AcceptedCheckpoint(**place, error_mm=error_mm, kept=len(checkpoints))
        return TrialStep(state, "checked", {"name": name, "error": error_mm}, entry)

    def _nearest_checkpoint(self, procedure: ProcedureState, now: TouchMoment) -> tuple[str, float]:
        """Return the checkpoint nearest to the tip by the registration in use, and how far, m."""
        if procedure.registration is None or not self._procedure.checkpoints:
            return "", 0.0
        plan = RegisteredPlan.of(procedure.registration.matrix)
        assert plan is not None, "what is in use is rigid"
        return plan.nearest_checkpoint(self._procedure.checkpoints, now.tip)

    def _refused_check(
        self, procedure: ProcedureState, name: str, error: float, now: TouchMoment
    ) -> str | None:
        """Return why a touch of a checkpoint does not count, None where it does."""
        radius = self._settings.checkpoint_radius
        if procedure.registration is None:
            return say("not in use yet")
        if not name:
            return say("no checkpoints")
        done = sum(len(each.checkpoints) for each in procedure.attempts)
        if done + len(procedure.checkpoints) >= MAX_TOUCHED_CHECKPOINTS:
            return say("too many checkpoints", most=MAX_TOUCHED_CHECKPOINTS)
        if error > radius:
            away, within = MM_PER_M * error, MM_PER_M * radius
            return say("too far from checkpoints", name=name, distance=away, radius=within)
        is_above = now.tip_clearance > self._touches.skin_tolerance
        if self._touches.touch_rule is TouchRule.ON_SKIN and is_above:
            return say("above a checkpoint", height=MM_PER_M * now.tip_clearance)
        return None

    def _accept(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        procedure = moment.procedure
        if procedure.registration is None:
            return RefusedStep(say("not in use yet"))
        attempts = (*procedure.attempts, _attempt(moment))
        state = moment.entering(Phase.ALIGNING, attempts=attempts, trajectory=0)
        return TrialStep(state, "align", {"name": procedure.trajectories[0].line.name})

    def _register_again(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Touch all points again; what was touched stays in the record as an attempt."""
        attempts = (*moment.procedure.attempts, _attempt(moment))
        if len(attempts) >= MAX_ATTEMPTS:
            return RefusedStep(say("too many attempts", most=MAX_ATTEMPTS))
        state = moment.entering(
            Phase.RUNNING, registration=None, checkpoints=(), trajectories=(), attempts=attempts
        )
        trace = None if state.trace is None else TraceState()
        again = replace(state, touches=(), next_point=self._labels[0], trace=trace)
        return TrialStep(again, "register again", {"point": self._labels[0]})

    def _lock(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Lock the guide where it is, if a drill in it would meet the head."""
        now, limit_mm = moment.now, STAND_OFF_LIMIT_MM
        ahead = now.feed.ahead
        if ahead.skin is None:
            return RefusedStep(say("off the head"))
        distance_mm = MM_PER_M * ahead.skin
        if distance_mm > limit_mm:
            return RefusedStep(say("too far to lock", distance=distance_mm, limit=limit_mm))
        entered = moment.entering(Phase.DRILLING)
        aligned = _present(entered)
        guide = GuideAxis(now.tip, now.direction)
        locked = replace(
            aligned,
            alignments=aligned.alignments + 1,
            guide=guide,
            is_self_aligned=aligned.is_self_aligned
            or GuideAlignment.of(guide, aligned.line).is_exact,
            drill_depth=0.0,
        )
        return TrialStep(
            _with_current(entered, locked),
            "drill",
            {"name": locked.line.name},
            data={"position_mm": in_millimeters(now.tip), "direction": now.direction},
            ahead=ahead.recorded(),
            feed=Feed(ahead=ahead),
        )

    def _retract(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Remove the drill and align again: only before it has cut bone."""
        if moment.now.feed.has_cut_bone:
            return RefusedStep(say("bone is cut"))
        state = moment.entering(Phase.ALIGNING)
        return TrialStep(state, "realign", {"name": _present(state).line.name}, feed=NO_FEED)

    def _start_insertion(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Exchange the drill for the instrument, which begins at the guide's tip."""
        feed = moment.now.feed
        if feed.drilled <= 0.0:
            return RefusedStep(say("nothing drilled"))
        entered = moment.entering(Phase.INSERTING)
        drilled = replace(_present(entered), drill_depth=feed.drilled)
        return TrialStep(
            _with_current(entered, drilled),
            "insert",
            {"name": drilled.line.name},
            feed=replace(feed, depth=0.0),
        )

    def _release(self, moment: ProcedureMoment) -> TrialStep | RefusedStep:
        """Leave the instrument where it is; the next line follows, or the end."""
        depth = moment.now.feed.depth
        if depth <= 0.0:
            return RefusedStep(say("still in the guide"))
        procedure = moment.procedure
        following = procedure.trajectory + 1
        is_last = following == len(procedure.trajectories)
        entered = moment.entering(Phase.REGISTERED if is_last else Phase.ALIGNING)
        placed = replace(_present(entered), instrument_depth=depth)
        state = _with_current(entered, placed)
        assert state.procedure is not None
        if is_last:
            ended = replace(state.procedure, ended_s=moment.elapsed)
            return TrialStep(replace(state, procedure=ended), "procedure done", feed=NO_FEED)
        onward = replace(state, procedure=replace(state.procedure, trajectory=following))
        name = procedure.trajectories[following].line.name
        return TrialStep(onward, "align next", {"name": name}, feed=NO_FEED)

    HANDLERS: ClassVar[
        Mapping[str, Callable[[ProcedurePhases, ProcedureMoment], TrialStep | RefusedStep]]
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


def _attempt(moment: ProcedureMoment) -> RegistrationAttempt:
    procedure = moment.procedure
    return RegistrationAttempt(moment.state.touches, procedure.registration, procedure.checkpoints)


def _present(state: TrainingState) -> TrajectoryState:
    """Return the current trajectory, also of a state that has just left its phases."""
    assert state.procedure is not None
    return state.procedure.trajectories[state.procedure.trajectory]


def _with_current(state: TrainingState, trajectory: TrajectoryState) -> TrainingState:
    assert state.procedure is not None
    return replace(state, procedure=state.procedure.with_present(trajectory))
