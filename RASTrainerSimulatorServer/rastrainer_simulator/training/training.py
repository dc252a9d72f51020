"""The trial: from StartTask over touches or a trace, and perhaps a procedure, to the score."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.journal.entries import AcceptedTouch, Rejected, Undo
from rastrainer.json_records import record_to_json
from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Event, OperatorCommand, TrainingState
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training import tracing
from rastrainer_simulator.training.feed import ProcedureSettings
from rastrainer_simulator.training.head_pose import PlacedHead, Truth
from rastrainer_simulator.training.procedure_phases import ProcedurePhases
from rastrainer_simulator.training.replies import (
    RefusedStep,
    TrainingReply,
    TrialStep,
    phase_change,
    summary,
    take_registration,
    take_score,
    trial_data,
)
from rastrainer_simulator.training.rules import (
    INTERRUPTED,
    RECORDING_FAILED,
    TRACED,
    TouchMoment,
    TrainingSettings,
    refusal,
    refused_touch,
)
from rastrainer_simulator.training.trial_start import (
    KeptStates,
    TrialClock,
    TrialStarter,
    interrupted,
    paused,
    resumed,
)
from rastrainer_simulator.trial_state import TouchState
from rastrainer_simulator.vectors import Vector

if TYPE_CHECKING:
    from rastrainer.scenario.points import Task
    from rastrainer.scenario.scenario import Scenario

REFUSAL_S = 5.0
"""For so long a refused touch's sentence takes the place of the instruction."""


class Training:
    """The state machine of a trial.

    `state` is what everyone may know, `truth` where the head really is. Time and the tip's position
    come with every command: the trial has no clock.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: int,
        settings: TrainingSettings | None = None,
        procedure: ProcedureSettings | None = None,
    ) -> None:
        self._scenario = scenario
        self._settings = settings or TrainingSettings()
        self._starter = TrialStarter(
            scenario, seed, self._settings, procedure or ProcedureSettings()
        )
        self._phases: ProcedurePhases | None = None
        self._clock = TrialClock(0.0)
        self._task: Task | None = None
        self._head = PlacedHead.nominal(scenario)
        self.trial_seed = 0
        self.state = TrainingState(instruction=say("idle"))
        self._kept = KeptStates()
        self._kept.begin(self.state)
        # Until when (simulated s) a refusal is shown, and the instruction that it stands for.
        self._refused_over: tuple[float, str] | None = None
        self._handlers: dict[str, Callable[[OperatorCommand, TouchMoment], TrainingReply]] = {
            **dict.fromkeys(ProcedurePhases.HANDLERS, self._in_procedure),
            CommandName.START_TASK: self._start,
            CommandName.CAPTURE: self._capture,
            CommandName.TRACE: self._trace,
            TRACED: self._traced,
            CommandName.UNDO: self._undo,
            CommandName.REGISTER: self._register,
            CommandName.ABORT: self._abort,
            CommandName.PAUSE: self._pause,
            CommandName.RESUME: self._resume,
            CommandName.SUBMIT_REGISTRATION: self._take_registration,
            CommandName.TRIAL_SCORED: self._scored,
            CommandName.GET_TRIAL: self._get_trial,
            RECORDING_FAILED: self._recording_failed,
            INTERRUPTED: self._interrupted,
        }

    def restart_from(self, revision: int) -> None:
        """Continue the revisions of another simulation, before the first trial."""
        self.state = replace(self.state, revision=revision)
        self._kept.begin(self.state)

    def resume_trial(
        self, revision: int, steps: Iterable[tuple[OperatorCommand, TouchMoment]]
    ) -> None:
        """Bring the trial of a journal to where it was when the server ended.

        `revision` is that before the trial, `steps` what was carried out since. A trial whose time
        was running is paused from the last step on.
        """
        self._leave()
        self.state = TrainingState(revision=revision)
        self._kept.begin(self.state)
        for command, moment in steps:
            self.handle(command, moment)

    @property
    def truth(self) -> Truth:
        return self._head.truth

    @property
    def goal(self) -> Vector | None:
        """Where the next fiducial is, World, m; None without one."""
        return self._head.fiducials.get(self.state.next_point or "")

    def handles(self, command: str) -> bool:
        return command in self._handlers

    def handle(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Carry out a command, or refuse it with a sentence about what would be right."""
        sentence = refusal(command, self.state, self._count)
        if sentence is not None:
            return TrainingReply(False, sentence)
        left = self.state.revision
        reply = self._handlers[command.name](command, now)
        if self.state.revision != left:
            self._kept.leave(left, now.feed)
        return reply

    def note_self_alignment(self) -> None:
        """Remember that the robot brings the guide onto the current line."""
        procedure = self.state.procedure
        assert procedure is not None, "the phase has a procedure"
        assert procedure.present is not None, "the phase has a trajectory"
        aligned = replace(procedure.present, is_self_aligned=True)
        self.state = replace(self.state, procedure=procedure.with_present(aligned))

    def trace(self, now: TouchMoment) -> tuple[Event, ...]:
        """Leave a point where the tip is if a stroke is being drawn there; return the events."""
        if not tracing.takes_point(self.state.trace, now, self._settings):
            return ()
        return self.handle(OperatorCommand(TRACED), now).events

    def end_refusal(self, sim_time: float) -> None:
        """Show the instruction again in place of a refusal that has been shown long enough."""
        if self._refused_over is not None and sim_time >= self._refused_over[0]:
            self.state = replace(self.state, instruction=self._refused_over[1])
            self._refused_over = None

    @property
    def _count(self) -> int:
        return len(self._task.labels) if self._task else 0

    def elapsed(self, sim_time: float) -> float:
        """Return the trial's time in s, pauses excluded."""
        return self._clock.time_of(self.state, sim_time)

    def _start(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        try:
            started = self._starter.start(command.arguments, self.state.revision)
        except InputError as error:
            return TrainingReply(False, str(error))
        self.trial_seed, self._task, self._phases = started.seed, started.task, started.phases
        self._head, self._clock = started.head, TrialClock(now.sim_time)
        self._kept.begin(TrainingState(revision=self.state.revision))
        event = self._enter(TrialStep(started.state, "start"), now)
        return TrainingReply(True, data=summary(self.state), events=(event,))

    def _in_procedure(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        assert self._phases is not None, "the phase has a procedure"
        elapsed = self._clock.elapsed(now.sim_time)
        step = self._phases.step(command, self.state, now, elapsed)
        if isinstance(step, TrialStep):
            return self._taken(step, now)
        return self._refused(step, now)

    def _taken(self, step: TrialStep, now: TouchMoment) -> TrainingReply:
        """Adopt the state of a step; a step without a change of phase may lead to one."""
        if step.entry is None:
            event = self._enter(step, now)
            answer = {**summary(self.state, **step.data), **step.answered}
            return TrainingReply(True, data=answer, events=(event,), feed=step.feed)
        answer = {**record_to_json(step.entry), **step.answered}
        events = [Event(now.sim_time, step.entry)]
        if step.state.phase is self.state.phase:
            self._keep(step)
        else:
            events.append(self._enter(step, now))
        return TrainingReply(True, data=answer, events=tuple(events), feed=step.feed)

    def _refused(self, step: RefusedStep, now: TouchMoment) -> TrainingReply:
        if step.entry is None:
            return TrainingReply(False, step.sentence)
        task = self.state.instruction if self._refused_over is None else self._refused_over[1]
        self._refused_over = now.sim_time + REFUSAL_S, task
        self.state = replace(self.state, instruction=step.sentence)
        event = Event(now.sim_time, step.entry)
        return TrainingReply(False, step.sentence, events=(event,))

    def _capture(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        if self.state.phase is Phase.VERIFYING:
            return self._in_procedure(command, now)
        state = self.state
        label, task = state.next_point, self._task
        assert label is not None
        assert task is not None, "the phase allows no touch before a task is chosen"
        sentence = refused_touch(now, label, self._head.fiducials, self._settings, state.method)
        place: dict[str, Any] = {
            "label": label,
            **tracing.tip_places(now.tip, measured := self._head.measured(now.tip)),
            "clearance_mm": MM_PER_M * now.tip_clearance,
            "depth_mm": MM_PER_M * now.depth,
        }
        if sentence is not None:
            self.state = replace(state, rejected=state.rejected + 1)
            return self._refused(RefusedStep(sentence, Rejected(**place, message=sentence)), now)
        touch = TouchState(label, measured, now.sim_time, self._clock.elapsed(now.sim_time))
        touches = (*state.touches, touch)
        following = task.labels[len(touches)] if len(touches) < len(task.labels) else None
        touched = replace(state, touches=touches, next_point=following)
        answered: Mapping[str, object] = {"nextPoint": following}
        key = "touched"
        values: Mapping[str, object] = {"label": label}
        if following is None and state.trace is not None:
            key, values = tracing.instruction(touched), tracing.counts(state.trace)
        elif following is None:
            touched = replace(touched, phase=Phase.COMPLETE)
            key, values, answered = "complete", {}, {}
        entry = AcceptedTouch(**place, kept=len(touches))
        return self._taken(TrialStep(touched, key, values, entry, answered=answered), now)

    def _trace(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Begin or end a stroke; a repeated command changes nothing."""
        trace, on = self.state.trace, command.arguments["on"]
        assert trace is not None, "the method has a trace"
        if on == trace.is_on:
            return TrainingReply(True, data=record_to_json(tracing.stroke_entry(trace)))
        state = tracing.begun(self.state) if on else tracing.ended(self.state)
        return self._taken(tracing.stroke(state), now)

    def _traced(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Add a point to the stroke, which ends with the last point that a trial accepts."""
        elapsed = self._clock.elapsed(now.sim_time)
        self.state = tracing.with_point(self.state, now, self._head.measured(now.tip), elapsed)
        event, trace = tracing.point_event(self.state, now), self.state.trace
        if trace is None or not trace.is_full:
            return TrainingReply(True, events=(event,))
        over = self._taken(tracing.stroke(tracing.ended(self.state)), now)
        return replace(over, events=(event, *over.events))

    def _undo(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        state = self.state
        if state.trace is not None and state.trace.strokes:
            return self._taken(tracing.stroke(tracing.undone(state), undone=True), now)
        if not state.touches:
            return TrainingReply(False, say("nothing to undo", point=state.next_point))
        label = state.touches[-1].label
        undone = replace(
            state,
            phase=Phase.RUNNING,
            touches=state.touches[:-1],
            next_point=label,
            undone=state.undone + 1,
        )
        entry = Undo(label, kept=len(state.touches) - 1, next_point=label)
        return self._taken(TrialStep(undone, "undone", {"label": label}, entry), now)

    def _register(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        if self._phases is not None:
            return self._in_procedure(command, now)
        registered = replace(self.state, phase=Phase.REGISTERED)
        answered = {"completionTimeS": self.state.completed_s}
        return self._taken(TrialStep(registered, "registered", answered=answered), now)

    def _abort(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        aborted = self.state
        self._leave()
        idle = TrainingState(revision=aborted.revision)
        self._kept.begin()
        event = self._enter(TrialStep(idle, "aborted", {"trainee": aborted.trainee}), now)
        return TrainingReply(True, data={"trialId": aborted.trial_id}, events=(event,))

    def _pause(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        self._clock.pause(now.sim_time)
        return self._entered(TrialStep(paused(self.state), "paused"), now)

    def _resume(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        self._clock.resume(now.sim_time)
        procedure = self.state.procedure
        if procedure is not None and procedure.stage in PROCEDURE_PHASES:
            assert self._phases is not None
            return self._taken(self._phases.resumed(self.state), now)
        return self._entered(resumed(self.state), now)

    def _take_registration(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        taken = take_registration(command.arguments, command.sender, self.state, self.truth)
        if not isinstance(taken, TrialStep):
            return taken
        return replace(self._taken(taken, now), data=taken.answered)

    def _scored(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        scored = take_score(command.arguments, self.state, self.truth)
        if not isinstance(scored, TrialStep):
            return scored
        return replace(self._entered(scored, now), data=scored.answered)

    def _get_trial(self, _command: OperatorCommand, _now: TouchMoment) -> TrainingReply:
        return TrainingReply(True, data=trial_data(self.state, self.truth))

    def _recording_failed(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Go back to the last revision that is on the disk, and pause."""
        found = self._kept.find(command.arguments["revision"])
        if found is None:
            return TrainingReply(True)
        kept, feed = found[0], found[1] or now.feed
        sentence = say("not recorded", reason=command.arguments["reason"])
        if kept.is_running:
            self._clock.pause(now.sim_time)
            kept = paused(kept)
        if kept.phase is Phase.IDLE:
            self._leave()
        back = replace(kept, revision=self.state.revision)
        then = replace(now, feed=feed)
        step = TrialStep(back, "not recorded", {"reason": command.arguments["reason"]})
        event = self._enter(step, then)
        return TrainingReply(True, message=sentence, events=(event,), feed=feed)

    def _interrupted(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Pause a trial that runs; one whose points are all touched has no time to stop."""
        if self.state.phase is not Phase.COMPLETE:
            self._clock.pause(now.sim_time)
        return self._entered(interrupted(self.state), now)

    def _entered(self, step: TrialStep, now: TouchMoment) -> TrainingReply:
        """Enter another phase, with nothing more to answer than that."""
        return TrainingReply(True, events=(self._enter(step, now),))

    def _enter(self, step: TrialStep, now: TouchMoment) -> Event:
        self._keep(step)
        entry = phase_change(self.state, now.feed, **step.data, ahead=step.ahead)
        return Event(now.sim_time, entry)

    def _keep(self, step: TrialStep) -> None:
        """Adopt a state that must not be lost, with its instruction."""
        state = step.state
        words: dict[str, Any] = {
            "trainee": state.trainee,
            "point": state.next_point,
            "count": self._count,
            **step.values,
        }
        revision = state.revision + 1
        instruction = say(step.key, **words)
        self._refused_over = None
        self.state = replace(state, revision=revision, instruction=instruction)
        self._kept.keep(self.state)

    def _leave(self) -> None:
        """Between trials the head is where it nominally is."""
        self._head = PlacedHead.nominal(self._scenario)
