"""The trial: from StartTask over touches or a trace, and perhaps a procedure, to the score."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.head.trial_head import SkinShift
from rastrainer.journal.entries import (
    AcceptedTouch,
    FinalRegistration,
    Rejected,
    TracePoint,
    Undo,
)
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import PROCEDURE_PHASES, TRACED_METHODS, Phase
from rastrainer.scenario.scenario import method_of, task_by_method
from rastrainer_simulator.state import Event, OperatorCommand, TrainingState
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training import tracing
from rastrainer_simulator.training.feed import Feed, ProcedureSettings
from rastrainer_simulator.training.head_pose import PlacedHead, Truth
from rastrainer_simulator.training.procedure_phases import ProcedurePhases
from rastrainer_simulator.training.replies import (
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
    DRAWN_SEED,
    TrialClock,
    interrupted,
    paused,
    resumed,
    trial_id,
    trial_seed,
)
from rastrainer_simulator.trial_state import ProcedureState, TouchState, TracedPoint, TraceState
from rastrainer_simulator.vectors import Vector

if TYPE_CHECKING:
    from rastrainer.scenario.points import Task
    from rastrainer.scenario.scenario import Scenario

REFUSAL_S = 5.0
"""For so long a refused touch's sentence takes the place of the instruction."""

Outcome = TrialStep | TrainingReply


class Training:
    """The state machine of a trial.

    `state` is what everyone may know, `truth` where the head really is. Time and the tip's position
    come with every command: the trial has no clock. Each trial of a session has its own ID and
    seed, which is as secret as the head's pose.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: int,
        settings: TrainingSettings | None = None,
        procedure: ProcedureSettings | None = None,
    ) -> None:
        self._scenario = scenario
        self._seed = seed
        self._number = 0
        self._settings = settings or TrainingSettings()
        self._procedure_settings = procedure or ProcedureSettings()
        self._phases: ProcedurePhases | None = None
        self._clock = TrialClock(0.0)
        self._task: Task | None = None
        self._head = PlacedHead.nominal(scenario)
        self.trial_seed = 0
        self.state = TrainingState(instruction=say("idle"))
        # Every state of the present trial by its revision, and the feed at which it was left.
        self._kept: dict[int, tuple[TrainingState, Feed | None]] = {0: (self.state, None)}
        # Until when (simulated s) a refusal is shown, and the instruction that it stands for.
        self._refused_over: tuple[float, str] | None = None
        self.handlers: dict[str, Callable[[OperatorCommand, TouchMoment], Outcome]] = {
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
            CommandName.SUBMIT_REGISTRATION: lambda command, _now: take_registration(
                command.arguments, command.sender, self.state, self.truth
            ),
            CommandName.TRIAL_SCORED: lambda command, _now: take_score(
                command.arguments, self.state, self.truth
            ),
            CommandName.GET_TRIAL: lambda _command, _now: TrainingReply(
                True, data=trial_data(self.state, self.truth)
            ),
            RECORDING_FAILED: self._recording_failed,
            INTERRUPTED: self._interrupted,
        }

    def restart_from(self, revision: int) -> None:
        """Continue the revisions of another simulation, before the first trial."""
        self._forget(replace(self.state, revision=revision))

    def resume_trial(
        self, revision: int, steps: Iterable[tuple[OperatorCommand, TouchMoment]]
    ) -> None:
        """Bring the trial of a journal to where it was when the server ended.

        `revision` is the last before the trial, `steps` the commands since then. A trial whose time
        was running is paused from the last step on.
        """
        self._head = PlacedHead.nominal(self._scenario)
        self._forget(TrainingState(revision=revision))
        for command, moment in steps:
            self.handle(command, moment)

    @property
    def truth(self) -> Truth:
        return self._head.truth

    def goal_of(self, state: TrainingState) -> Vector | None:
        """Return where the next fiducial is in a state of the trial, World, m; None without one."""
        return self._head.fiducials.get(state.next_point or "")

    def handle(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Carry out a command, or refuse it with a sentence about what would be right."""
        sentence = refusal(command, self.state, self._count)
        if sentence is not None:
            return TrainingReply(False, sentence)
        left = self.state.revision
        outcome = self.handlers[command.name](command, now)
        if isinstance(outcome, TrialStep):
            reply = self._taken(outcome, now)
        else:
            reply = outcome
            if not reply.ok and reply.events:
                # A touch does not count: why stands in place of the instruction for some seconds.
                task = self._refused_over[1] if self._refused_over else self.state.instruction
                self._refused_over = now.sim_time + REFUSAL_S, task
                self.state = replace(self.state, instruction=reply.message)
        if self.state.revision != left and left in self._kept:
            self._kept[left] = self._kept[left][0], now.feed
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
        return self._clock.time_of(self.state, sim_time)

    def _start(self, command: OperatorCommand, now: TouchMoment) -> Outcome:
        arguments, scenario, revision = command.arguments, self._scenario, self.state.revision
        procedure, number = arguments.get("procedure") or "", self._number
        seed = arguments.get("seed")
        if seed is None:
            seed = arguments.get(DRAWN_SEED, trial_seed(self._seed, number))
        try:
            method = method_of(arguments.get("method"))
            chosen = arguments.get("skin")
            skin = record_from_json(SkinShift, chosen) if chosen else scenario.skin
            task = task_by_method(scenario, arguments["task"], method)
            plan = scenario.procedure(procedure) if procedure else None
            self._head = PlacedHead.of_trial(scenario, task, seed, skin)
        except InputError as error:
            return TrainingReply(False, str(error))
        self.trial_seed, self._number, self._task = seed, number + 1, task
        self._clock = TrialClock(now.sim_time)
        self._phases = None
        if plan is not None:
            settings = self._settings, self._procedure_settings
            self._phases = ProcedurePhases(plan, task.labels, *settings)
        self._forget(TrainingState(revision=revision))
        started = TrainingState(
            phase=Phase.RUNNING,
            trainee=arguments["trainee"],
            task=task.name,
            mode=arguments["mode"],
            trial_id=arguments.get("trialId") or trial_id(self._seed, number),
            next_point=task.labels[0],
            revision=revision,
            procedure=ProcedureState(procedure) if procedure else None,
            method=method,
            trace=TraceState() if method in TRACED_METHODS else None,
        )
        return TrialStep(started, "start")

    def _in_procedure(self, command: OperatorCommand, now: TouchMoment) -> Outcome:
        assert self._phases is not None, "the phase has a procedure"
        elapsed = self._clock.elapsed(now.sim_time)
        return self._phases.step(command, self.state, now, elapsed)

    def _taken(self, step: TrialStep, now: TouchMoment) -> TrainingReply:
        """Adopt the state of a step, with its instruction: it must not be lost."""
        entry, events = step.entry, []
        answer = dict(step.answered)
        if entry is not None:
            events.append(Event(now.sim_time, entry))
            if not isinstance(entry, FinalRegistration):
                answer = {**record_to_json(entry), **answer}
        has_entered = entry is None or step.state.phase is not self.state.phase
        words: dict[str, Any] = {
            "trainee": step.state.trainee,
            "point": step.state.next_point,
            "count": self._count,
            **step.values,
        }
        revision, instruction = step.state.revision + 1, say(step.key, **words)
        self._refused_over = None
        self.state = replace(step.state, revision=revision, instruction=instruction)
        self._kept[revision] = self.state, None
        if has_entered:
            if entry is None and step.has_summary:
                answer = {**summary(self.state, **step.data), **answer}
            change = phase_change(self.state, now.feed, **step.data, ahead=step.ahead)
            events.append(Event(now.sim_time, change))
        return TrainingReply(True, data=answer, events=tuple(events), feed=step.feed)

    def _capture(self, command: OperatorCommand, now: TouchMoment) -> Outcome:
        if self.state.phase is Phase.VERIFYING:
            return self._in_procedure(command, now)
        state = self.state
        label, task = state.next_point, self._task
        assert label is not None
        assert task is not None, "the phase allows no touch before a task is chosen"
        sentence = refused_touch(now, label, self._head.fiducials, self._settings, state.method)
        measured = self._head.measured(now.tip)
        place = {"label": label, **now.place, **tracing.tip_places(now.tip, measured)}
        if sentence is not None:
            self.state = replace(state, rejected=state.rejected + 1)
            event = Event(now.sim_time, Rejected(**place, message=sentence))
            return TrainingReply(False, sentence, events=(event,))
        touch = TouchState(label, measured, now.sim_time, self._clock.elapsed(now.sim_time))
        touches = (*state.touches, touch)
        following = task.labels[len(touches)] if len(touches) < len(task.labels) else None
        touched = replace(state, touches=touches, next_point=following)
        entry = AcceptedTouch(**place, kept=len(touches))
        step = TrialStep(touched, "touched", {"label": label}, entry)
        if following is None and state.trace is None:
            return replace(step, state=replace(touched, phase=Phase.COMPLETE), key="complete")
        if following is None and state.trace is not None:
            key, values = tracing.instruction(touched), tracing.counts(state.trace)
            step = replace(step, key=key, values=values)
        return replace(step, answered={"nextPoint": following})

    def _trace(self, command: OperatorCommand, _now: TouchMoment) -> Outcome:
        trace, on = self.state.trace, command.arguments["on"]
        assert trace is not None, "the method has a trace"
        if on == trace.is_on:
            return TrainingReply(True, data=record_to_json(tracing.stroke_entry(trace)))
        return tracing.stroke(self.state, trace.begun() if on else trace.ended())

    def _traced(self, _command: OperatorCommand, now: TouchMoment) -> Outcome:
        """Add a point to the stroke, which ends with the last point that a trial accepts."""
        assert self.state.trace is not None, "a stroke is being drawn"
        measured = self._head.measured(now.tip)
        tip = None if measured == now.tip else now.tip
        elapsed = self._clock.elapsed(now.sim_time)
        trace = self.state.trace.with_point(TracedPoint(measured, now.sim_time, elapsed, tip))
        self.state = replace(self.state, trace=trace)
        place = tracing.tip_places(now.tip, measured)
        event = Event(now.sim_time, TracePoint(**place, kept=len(trace.points)))
        if not trace.is_full:
            return TrainingReply(True, events=(event,))
        over = self._taken(tracing.stroke(self.state, trace.ended()), now)
        return replace(over, events=(event, *over.events))

    def _undo(self, _command: OperatorCommand, _now: TouchMoment) -> Outcome:
        state = self.state
        if state.trace is not None and state.trace.strokes:
            return tracing.stroke(state, state.trace.undone(), undone=True)
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
        return TrialStep(undone, "undone", {"label": label}, entry)

    def _register(self, command: OperatorCommand, now: TouchMoment) -> Outcome:
        if self._phases is not None:
            return self._in_procedure(command, now)
        registered = replace(self.state, phase=Phase.REGISTERED)
        answered = {"completionTimeS": self.state.completed_s}
        return TrialStep(registered, "registered", answered=answered)

    def _abort(self, _command: OperatorCommand, _now: TouchMoment) -> Outcome:
        """The head is put where the scenario has it."""
        aborted = self.state
        self._head = PlacedHead.nominal(self._scenario)
        self._kept = {}
        idle = TrainingState(revision=aborted.revision)
        values = {"trainee": aborted.trainee}
        answered = {"trialId": aborted.trial_id}
        return TrialStep(idle, "aborted", values, answered=answered, has_summary=False)

    def _pause(self, _command: OperatorCommand, now: TouchMoment) -> Outcome:
        self._clock.pause(now.sim_time)
        return TrialStep(paused(self.state), "paused", has_summary=False)

    def _resume(self, _command: OperatorCommand, now: TouchMoment) -> Outcome:
        self._clock.resume(now.sim_time)
        procedure = self.state.procedure
        if procedure is not None and procedure.stage in PROCEDURE_PHASES:
            assert self._phases is not None
            return self._phases.resumed(self.state)
        return resumed(self.state)

    def _recording_failed(self, command: OperatorCommand, now: TouchMoment) -> Outcome:
        """Go back to the last revision that is on the disk, and pause."""
        kept, feed = self._kept.get(command.arguments["revision"], (None, None))
        if kept is None:
            return TrainingReply(True)
        if kept.is_running:
            self._clock.pause(now.sim_time)
            kept = paused(kept)
        if kept.phase is Phase.IDLE:
            self._head = PlacedHead.nominal(self._scenario)
        back = replace(kept, revision=self.state.revision)
        values, then = {"reason": command.arguments["reason"]}, replace(now, feed=feed or now.feed)
        reply = self._taken(TrialStep(back, "not recorded", values, feed=then.feed), then)
        return replace(reply, message=self.state.instruction)

    def _interrupted(self, _command: OperatorCommand, now: TouchMoment) -> Outcome:
        """Pause a trial that runs; one whose points are all touched has no time to stop."""
        if self.state.phase is not Phase.COMPLETE:
            self._clock.pause(now.sim_time)
        return interrupted(self.state)

    def _forget(self, state: TrainingState) -> None:
        self.state, self._kept = state, {state.revision: (state, None)}
