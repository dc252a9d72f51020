"""The trial: from StartTask over touches or a trace, and perhaps a procedure, to the score."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING

from rastrainer.errors import InputError
from rastrainer.head.skin_shift import SkinShift
from rastrainer.protocol import PROCEDURE_PHASES, CommandName, Phase
from rastrainer.scenario.method_task import TRACED_METHODS, method_of, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.operator_input import OperatorCommand
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.procedure_state import ProcedureState
from rastrainer_simulator.registration_state import FinalRegistration, TouchState, TraceState
from rastrainer_simulator.state import Event, EventKind, TrainingState, TrialResult
from rastrainer_simulator.training import tracing
from rastrainer_simulator.training.feed import ProcedureSettings, recorded_feed
from rastrainer_simulator.training.placed_head import PlacedHead
from rastrainer_simulator.training.procedure_phases import (
    OF_A_PROCEDURE,
    PhaseStep,
    ProcedurePhases,
    RefusedStep,
)
from rastrainer_simulator.training.replies import TrainingReply, given, revealed, summary
from rastrainer_simulator.training.rules import (
    INTERRUPTED,
    RECORDING_FAILED,
    TRACED,
    TouchMoment,
    TrainingSettings,
    refusal,
    refused_touch,
)
from rastrainer_simulator.training.trial_clock import KeptStates, TrialClock, trial_id, trial_seed
from rastrainer_simulator.training.true_error import Truth
from rastrainer_simulator.vectors import Vector

if TYPE_CHECKING:
    from rastrainer.scenario.scenario import Scenario
    from rastrainer.scenario.tasks import Task


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
        texts: Texts | None = None,
        procedure: ProcedureSettings | None = None,
    ) -> None:
        self._scenario = scenario
        self._seed = seed
        self._settings = settings or TrainingSettings()
        self._procedure_settings = procedure or ProcedureSettings()
        self._phases: ProcedurePhases | None = None
        self._texts = texts or Texts()
        self._number = 0
        self._clock = TrialClock(0.0)
        self._task: Task | None = None
        self._head = PlacedHead.nominal(scenario)
        self.trial_seed = 0
        self.state = TrainingState(instruction=self._texts.say("idle"))
        self._kept = KeptStates()
        self._kept.begin(self.state)
        self._handlers: dict[str, Callable[[OperatorCommand, TouchMoment], TrainingReply]] = {
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
            **dict.fromkeys(OF_A_PROCEDURE, self._in_procedure),
            RECORDING_FAILED: self._recording_failed,
            INTERRUPTED: self._interrupted,
        }

    def restart_from(self, revision: int) -> None:
        """Count revisions on from another simulation's, before the first trial."""
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
        """Where the head really is."""
        return self._head.truth

    @property
    def goal(self) -> Vector | None:
        """Where the next fiducial is, World, m; None without one."""
        return self._head.fiducials.get(self.state.next_point or "")

    def handles(self, command: str) -> bool:
        """Return whether a command is the trial's business."""
        return command in self._handlers

    def handle(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Carry out a command, or refuse it with a sentence about what would be right."""
        sentence = refusal(command, self.state, self._texts, self._count)
        if sentence is not None:
            return TrainingReply(False, sentence)
        left = self.state.revision
        reply = self._handlers[command.name](command, now)
        if self.state.revision != left:
            self._kept.leave(left, now.feed)
        return reply

    def trace(self, now: TouchMoment) -> tuple[Event, ...]:
        """Leave a point where the tip is if a stroke is being drawn there; return the events."""
        if not tracing.takes_point(self.state.trace, now, self._settings):
            return ()
        return self.handle(OperatorCommand(TRACED), now).events

    @property
    def _count(self) -> int:
        """How many points the trial has to touch."""
        return len(self._task.labels) if self._task else 0

    def elapsed(self, sim_time: float) -> float:
        """Return the trial's time in s, pauses excluded.

        It ends with the last point that was touched or traced, or with the procedure.
        """
        phase, procedure = self.state.phase, self.state.procedure
        if phase is Phase.IDLE:
            return 0.0
        if procedure is not None and procedure.ended_s is not None:
            return procedure.ended_s
        if procedure is not None or phase in (Phase.RUNNING, Phase.PAUSED):
            return self._clock.elapsed(sim_time)
        return self.state.completed_s

    def _start(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        arguments = command.arguments
        chosen_procedure = arguments.get("procedure") or ""
        skin = SkinShift.from_json(arguments.get("skin") or self._scenario.skin.amounts)
        try:
            method = method_of(arguments.get("method"))
            task = task_by_method(self._scenario, arguments["task"], method)
            phases = self._phases_of(chosen_procedure, task)
            number, chosen = self._number, arguments.get("seed")
            seed = trial_seed(self._seed, number) if chosen is None else chosen
            self._head = PlacedHead.of_trial(self._scenario, task, seed, skin)
        except InputError as error:
            return TrainingReply(False, str(error))
        self._number += 1
        self.trial_seed, self._task, self._phases = seed, task, phases
        self._clock = TrialClock(now.sim_time)
        idle = TrainingState(revision=self.state.revision)
        self._kept.begin(idle)
        started = TrainingState(
            phase=Phase.RUNNING,
            trainee=arguments["trainee"],
            task=task.name,
            mode=arguments["mode"],
            trial_id=arguments.get("trialId") or trial_id(self._seed, number),
            next_point=task.labels[0],
            revision=self.state.revision,
            procedure=ProcedureState(chosen_procedure) if chosen_procedure else None,
            method=method,
            trace=TraceState() if method in TRACED_METHODS else None,
        )
        event = self._enter(started, "start", now)
        return TrainingReply(True, data=summary(self.state), events=(event,))

    def _phases_of(self, procedure: str, task: Task) -> ProcedurePhases | None:
        """Return the phases of a procedure, None without one.

        Raises:
            InputError: the scenario has no such procedure.
        """
        if not procedure:
            return None
        plan = self._scenario.procedure(procedure)
        settings = self._procedure_settings
        return ProcedurePhases(plan, task.labels, self._settings, settings, self._texts)

    def _in_procedure(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Carry out a command of the procedure in its phase."""
        assert self._phases is not None, "the phase has a procedure"
        elapsed = self._clock.elapsed(now.sim_time)
        step = self._phases.step(command, self.state, now, elapsed)
        if isinstance(step, PhaseStep):
            return self._taken(step, now)
        return self._refused(step, now)

    def _taken(self, step: PhaseStep, now: TouchMoment) -> TrainingReply:
        if step.kind is EventKind.PHASE:
            event = self._enter(step.state, step.key, now, **step.values)
            event = replace(event, data={**event.data, **step.data, **step.recorded})
            data = {**summary(self.state), **step.data}
            return TrainingReply(True, data=data, events=(event,), feed=step.feed)
        self._keep(step.state, step.key, **step.values)
        event = Event(step.kind, now.sim_time, step.data)
        return TrainingReply(True, data=step.data, events=(event,), feed=step.feed)

    def _refused(self, step: RefusedStep, now: TouchMoment) -> TrainingReply:
        if step.data is None:
            return TrainingReply(False, step.sentence)
        self.state = replace(self.state, instruction=step.sentence)
        event = Event(EventKind.REJECTED, now.sim_time, step.data)
        return TrainingReply(False, step.sentence, events=(event,))

    def _capture(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        if self.state.phase is Phase.VERIFYING:
            return self._in_procedure(command, now)
        state = self.state
        label, task = state.next_point, self._task
        assert label is not None
        assert task is not None, "the phase allows no touch before a task is chosen"
        sentence = refused_touch(
            now, label, self._head.fiducials, self._settings, self._texts, state.method
        )
        place = {
            "label": label,
            **tracing.tip_data(now, measured := self._head.measured(now.tip)),
            "clearanceMm": MM_PER_M * now.tip_clearance,
            "depthMm": MM_PER_M * now.depth,
        }
        if sentence is not None:
            self.state = replace(state, rejected=state.rejected + 1, instruction=sentence)
            data = {**place, "message": sentence}
            return TrainingReply(
                False, sentence, events=(Event(EventKind.REJECTED, now.sim_time, data),)
            )
        touch = TouchState(label, measured, now.sim_time, self._clock.elapsed(now.sim_time))
        touches = (*state.touches, touch)
        data = {**place, "kept": len(touches)}
        event = Event(EventKind.TOUCH, now.sim_time, data)
        if len(touches) == len(task.labels) and state.trace is not None:
            self._keep_traced(replace(state, touches=touches, next_point=None))
            return TrainingReply(True, data={**data, "nextPoint": None}, events=(event,))
        if len(touches) == len(task.labels):
            complete = replace(state, phase=Phase.COMPLETE, touches=touches, next_point=None)
            return TrainingReply(
                True, data=data, events=(event, self._enter(complete, "complete", now))
            )
        following = task.labels[len(touches)]
        touched = replace(state, touches=touches, next_point=following)
        self._keep(touched, "touched", label=label)
        return TrainingReply(True, data={**data, "nextPoint": following}, events=(event,))

    def _trace(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Begin or end a stroke; a command that has come before changes nothing."""
        trace, on = self.state.trace, command.arguments["on"]
        assert trace is not None, "the method has a trace"
        if on == trace.is_on:
            return TrainingReply(True, data=tracing.stroke_data(trace))
        state = tracing.begun(self.state) if on else tracing.ended(self.state)
        return self._stroke(state, now)

    def _traced(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Add a point to the stroke, which ends with the last one that a trial takes."""
        elapsed = self._clock.elapsed(now.sim_time)
        self.state = tracing.with_point(self.state, now, self._head.measured(now.tip), elapsed)
        event, trace = tracing.point_event(self.state, now), self.state.trace
        if trace is None or not trace.is_full:
            return TrainingReply(True, events=(event,))
        over = self._stroke(tracing.ended(self.state), now)
        return replace(over, events=(event, *over.events))

    def _stroke(self, state: TrainingState, now: TouchMoment, **others: bool) -> TrainingReply:
        """Take on a state in which a stroke has begun, is ended or undone."""
        assert state.trace is not None
        data = {**tracing.stroke_data(state.trace), **others}
        event = Event(EventKind.STROKE, now.sim_time, data)
        if state.phase is self.state.phase:
            self._keep_traced(state)
            return TrainingReply(True, data=data, events=(event,))
        phase = self._enter(state, tracing.instruction(state), now, **tracing.counts(state.trace))
        return TrainingReply(True, data=data, events=(event, phase))

    def _keep_traced(self, state: TrainingState) -> None:
        assert state.trace is not None
        self._keep(state, tracing.instruction(state), **tracing.counts(state.trace))

    def _undo(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        state = self.state
        if state.trace is not None and state.trace.strokes:
            return self._stroke(tracing.undone(state), now, undone=True)
        if not state.touches:
            return TrainingReply(False, self._texts.say("nothing to undo", point=state.next_point))
        label = state.touches[-1].label
        data = {"label": label, "kept": len(state.touches) - 1, "nextPoint": label}
        events = [Event(EventKind.UNDO, now.sim_time, data)]
        undone = replace(
            state,
            phase=Phase.RUNNING,
            touches=state.touches[:-1],
            next_point=label,
            undone=state.undone + 1,
        )
        if state.phase is Phase.RUNNING:
            self._keep(undone, "undone", label=label)
        else:
            events.append(self._enter(undone, "undone", now, label=label))
        return TrainingReply(True, data=data, events=tuple(events))

    def _register(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        if self._phases is not None:
            return self._in_procedure(command, now)
        event = self._enter(replace(self.state, phase=Phase.REGISTERED), "registered", now)
        data = {**summary(self.state), "completionTimeS": self.state.completed_s}
        return TrainingReply(True, data=data, events=(event,))

    def _abort(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        aborted = self.state
        self._leave()
        idle = TrainingState(revision=aborted.revision)
        self._kept.begin()
        event = self._enter(idle, "aborted", now, trainee=aborted.trainee)
        return TrainingReply(True, data={"trialId": aborted.trial_id}, events=(event,))

    def _pause(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        self._clock.pause(now.sim_time)
        paused = replace(tracing.ended(self.state), phase=Phase.PAUSED)
        return TrainingReply(True, events=(self._enter(paused, "paused", now),))

    def _resume(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        self._clock.resume(now.sim_time)
        procedure = self.state.procedure
        if procedure is not None and procedure.stage in PROCEDURE_PHASES:
            assert self._phases is not None
            return self._taken(self._phases.resumed(self.state), now)
        running, trace = replace(self.state, phase=Phase.RUNNING), self.state.trace
        if trace is None or self.state.next_point is not None:
            return TrainingReply(True, events=(self._enter(running, "resumed", now),))
        resumed = tracing.ended(running)
        key = tracing.instruction(resumed)
        event = self._enter(resumed, key, now, **tracing.counts(trace))
        return TrainingReply(True, events=(event,))

    def _take_registration(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Accept a registration, which becomes final, and reveal the truth."""
        known = self.state.registration
        registration = FinalRegistration.from_arguments(command.arguments)
        if known is not None and not known.agrees_with(registration):
            return TrainingReply(False, self._texts.say("registration is final"))
        matrix = registration.matrix if known is None else known.matrix
        data = {"trialId": self.state.trial_id, **revealed(self.truth, self.state, matrix)}
        if known is not None:
            return TrainingReply(True, data=data)
        key = "registered" if self._phases is None else "procedure done"
        self._keep(replace(self.state, registration=registration), key)
        event = Event(EventKind.REGISTRATION, now.sim_time, {"trialId": self.state.trial_id})
        return TrainingReply(True, data=data, events=(event,))

    def _scored(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        arguments, registration = command.arguments, self.state.registration
        data = {"trialId": self.state.trial_id}
        if registration is None:
            return TrainingReply(False, self._texts.say("no registration"))
        result = TrialResult(
            registration=registration,
            true_tre_mm=revealed(self.truth, self.state, registration.matrix)["trueTreMm"],
            score=arguments["score"],
            details=arguments["details"],
        )
        if result == self.state.result:
            return TrainingReply(True, data=data)
        scored = replace(self.state, phase=Phase.SCORED, result=result)
        event = self._enter(
            scored,
            "scored",
            now,
            score=result.score,
            fre=registration.fre_mm,
            tre=result.true_tre_mm,
        )
        return TrainingReply(True, data=data, events=(event,))

    def _get_trial(self, _command: OperatorCommand, _now: TouchMoment) -> TrainingReply:
        state = self.state
        data = {**summary(state), **given(state)}
        if state.registration is not None:
            data.update(revealed(self.truth, state, state.registration.matrix))
        return TrainingReply(True, data=data)

    def _recording_failed(self, command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Go back to the last revision that is on the disk, and pause."""
        found = self._kept.find(command.arguments["revision"])
        if found is None:
            return TrainingReply(True)
        kept, feed = found[0], found[1] or now.feed
        sentence = self._texts.say("not recorded", reason=command.arguments["reason"])
        if kept.phase in (Phase.RUNNING, *PROCEDURE_PHASES):
            self._clock.pause(now.sim_time)
            kept = replace(tracing.ended(kept), phase=Phase.PAUSED)
        if kept.phase is Phase.IDLE:
            self._leave()
        back = replace(kept, revision=self.state.revision)
        then = replace(now, feed=feed)
        event = self._enter(back, "not recorded", then, reason=command.arguments["reason"])
        return TrainingReply(True, message=sentence, events=(event,), feed=feed)

    def _interrupted(self, _command: OperatorCommand, now: TouchMoment) -> TrainingReply:
        """Pause a trial that runs; one whose points are all touched has no time to stop."""
        trace = self.state.trace
        values = {} if trace is None else tracing.counts(trace)
        if self.state.phase is Phase.COMPLETE:
            key = "interrupted complete" if trace is None else "interrupted trace"
            event = self._enter(self.state, key, now, **values)
        else:
            self._clock.pause(now.sim_time)
            paused = replace(tracing.ended(self.state), phase=Phase.PAUSED)
            key = _interruption(paused)
            event = self._enter(paused, key, now, kept=len(paused.touches), **values)
        return TrainingReply(True, events=(event,))

    def _enter(self, state: TrainingState, key: str, now: TouchMoment, **values: object) -> Event:
        """Enter another phase and return the event of it."""
        self._keep(state, key, **values)
        data = {
            **summary(self.state),
            "instruction": self.state.instruction,
            **recorded_feed(now.feed),
        }
        return Event(EventKind.PHASE, now.sim_time, data)

    def _keep(self, state: TrainingState, key: str, **values: object) -> None:
        """Take on a state that must not be lost, with the instruction that goes with it."""
        words = {
            "trainee": state.trainee,
            "point": state.next_point,
            "count": self._count,
            **values,
        }
        revision = state.revision + 1
        instruction = self._texts.say(key, **words)
        self.state = replace(state, revision=revision, instruction=instruction)
        self._kept.keep(self.state)

    def _leave(self) -> None:
        """Between trials the head is where it nominally is."""
        self._head = PlacedHead.nominal(self._scenario)


def _interruption(state: TrainingState) -> str:
    """Return the key of what is said of a trial that was interrupted in its midst."""
    procedure = state.procedure
    if procedure is not None and procedure.stage in PROCEDURE_PHASES:
        return "interrupted procedure"
    return "interrupted" if state.next_point is not None else "interrupted trace"
