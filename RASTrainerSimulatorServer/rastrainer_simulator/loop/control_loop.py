"""Own the time: step the simulation 250 times a second, record it, and publish the result."""

from __future__ import annotations

import logging
import threading
import time
import uuid
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

from rastrainer.commands import COMMANDS, CommandName
from rastrainer.errors import RASTrainerError
from rastrainer.journal.entries import PlayingSession, Report, Stamp
from rastrainer.journal.journal_file import JournalReading
from rastrainer.protocol import FINISHED_PHASES, OPEN_PHASES
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.results import DurableResults, PendingAnswers, Subscribers
from rastrainer_simulator.loop.timing import (
    LoopStatistics,
    RateLimit,
    TrialLimits,
    precise_timing,
    raise_thread_priority,
    sleep_until,
)
from rastrainer_simulator.record.trial_archive import TrialArchive
from rastrainer_simulator.record.trial_recorder import TrialRecorder
from rastrainer_simulator.state import (
    NEUTRAL_STICKS,
    Answer,
    OperatorCommand,
    OperatorInput,
    SimulationState,
    StepResult,
)
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.rules import ENDING_A_TRIAL, RECORDING_FAILED, REFUSALS

CATCH_UP_S = 0.1
"""Delay up to which the loop catches up tick by tick."""
COMMANDS_PER_TICK = 16
SHUTTING_DOWN = "The simulator is shutting down."
ARCHIVE_FAILED = "The trial's record could not be used: the simulator's log says why."
TRIAL_IS_OPEN = say("no other head in a trial")
BEING_SET_UP = say("being set up")
TOO_MANY_STARTS = say("too many starts")

_BEGIN_REPLACEMENT = "BeginReplacement"
"""Waits for its turn among the commands; clients cannot send it."""

_STATELESS_COMMANDS = {each for each in COMMANDS.values() if each.is_stateless}
_ALLOWED_FOR_PAST_TRIALS = {each for each in COMMANDS.values() if each.is_for_past_trials}

_log = logging.getLogger(__name__)


class ControlLoop:
    """Runs a simulation in its own thread.

    Tick times are counted from the first tick, so that delays do not add up; late ticks are counted
    in `statistics`. Changes of a trial are published and answered only when they are on the disk.
    """

    def __init__(
        self,
        simulation: Simulation,
        records: Path,
        rate_hz: float = 250.0,
        speed: float | None = 1.0,
        interrupted: JournalReading | None = None,
        trial_limits: TrialLimits | None = None,
        is_seeded: bool = False,
    ) -> None:
        """Prepare the loop; its thread is to be started.

        `speed` is in simulated seconds a second; with None it runs as fast as the machine can.
        `interrupted` is the journal of a trial that the simulation has loaded; it waits for Resume.
        """
        self.simulation = simulation
        """The present one; it belongs to the loop's thread."""
        self.tick_s = 1.0 / rate_hz
        self._period = 0.0 if speed is None else self.tick_s / speed
        self.archive = TrialArchive(records)
        """The trials that are over, and those that wait to be acknowledged."""
        self.is_first_in_line = self._period >= self.tick_s
        """Whether it runs before all other threads; if it never slept, they would never run."""
        self._writer = ThreadPoolExecutor(
            max_workers=1,
            thread_name_prefix="journal",
            initializer=raise_thread_priority if self.is_first_in_line else None,
        )
        self.playing = PlayingSession(speed, is_seeded)
        self._recorder = TrialRecorder(
            records, self.archive, self._writer, self.tick_s, self.playing
        )
        if interrupted is not None:
            self._recorder.resume_trial(simulation, interrupted)
        self._state = simulation.state
        self._held = DurableResults(self._state.training)
        self._sticks = NEUTRAL_STICKS
        self._arrived: deque[OperatorCommand] = deque()
        self._displayed: deque[Report] = deque()
        self.note_display = self._displayed.append
        """Records in the trial's journal what its views show."""
        self._answers = PendingAnswers()
        limits = trial_limits or TrialLimits()
        self._starts = RateLimit(limits.starts_per_s, limits.starts_at_once)
        self._refused: str | None = None
        self.is_being_replaced = False
        """Whether another simulation is being made: no trial begins on the present one."""
        self._successor: tuple[Simulation, int] | None = None
        self._subscribers: Subscribers[StepResult] = Subscribers()
        self.subscribe = self._subscribers.add
        """Calls a callback in the loop's thread after each tick; it must return immediately."""
        self.statistics = LoopStatistics()
        self.thread = threading.Thread(target=self._run, name="control loop", daemon=True)
        self._is_stopping = threading.Event()
        self.latest: SimulationState = self._state
        """The last published state."""

    @property
    def setup(self) -> SimulationSetup:
        return self.simulation.setup

    def __enter__(self) -> ControlLoop:
        self.thread.start()
        return self

    def __exit__(self, *_exception: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Stop ticking, and return when everything recorded is on the disk."""
        self._is_stopping.set()
        if self.thread.is_alive():
            self.thread.join()

    def write(self, work: Callable[[], None]) -> Future[None]:
        """Have something written in the thread that writes to the disk, after all before it."""
        return self._writer.submit(work)

    def hold_sticks(self, sticks: OperatorInput) -> None:
        self._sticks = replace(sticks, commands=())

    def submit(
        self, name: str, arguments: Mapping[str, Any] | None = None, sender: str = ""
    ) -> Future[Answer]:
        """Carry out a command in one of the next ticks.

        `arguments` have passed `rastrainer.commands.check_arguments`. The answer comes
        when the change is on the disk.
        """
        ticket, future = self._answers.expect()
        arguments = dict(arguments or {})
        if name == CommandName.START_TASK:
            # Drawn outside of the simulation: a seed used twice must not make one trial of two.
            arguments.setdefault("trialId", str(uuid.uuid4()))
        self._arrived.append(OperatorCommand(name, arguments, ticket, sender))
        return future

    def begin_replacement(self) -> Future[Answer]:
        """Have no trial begin from now on, since another simulation is being made.

        Refused while a trial is open. It takes its turn among the commands: trials that were
        requested before have begun. If it is not refused, the caller may call
        `replace_simulation` and must call `end_replacement`.
        """
        return self.submit(_BEGIN_REPLACEMENT)

    def replace_simulation(self, simulation: Simulation) -> Future[Answer]:
        assert self.is_being_replaced, "a trial could be open"
        ticket, future = self._answers.expect()
        self._successor = (simulation, ticket)
        return future

    def end_replacement(self) -> None:
        """Let trials begin again, on the simulation that is there now."""
        self.is_being_replaced = False

    def _run(self) -> None:
        try:
            with precise_timing(self.is_first_in_line):
                due = time.monotonic()
                while not self._is_stopping.is_set():
                    self.statistics.count(time.monotonic() - due if self._period else 0.0)
                    self._tick()
                    due += self._period
                    behind = time.monotonic() - due
                    if self._period and behind > CATCH_UP_S:
                        skipped = int(behind / self._period)
                        self.statistics.skipped += skipped
                        due += skipped * self._period
                    sleep_until(due)
        except Exception:
            _log.exception("The control loop has failed")
        finally:
            self._finish()

    def _tick(self) -> None:
        if self._successor is not None and not self._held.is_waiting:
            (self.simulation, ticket), self._successor = self._successor, None
            self.simulation.restart_from(self._state.starting_point)
            self._answers.give(Answer(ticket, True))
        commands = self._commands()
        operator_input = replace(self._sticks, commands=commands) if commands else self._sticks
        while self._displayed:
            self._recorder.note_display(self._displayed.popleft(), self._state)
        result = self.simulation.step(self.tick_s, operator_input)
        written = self._recorder.record(self.simulation, self._state, operator_input, result)
        self._state = result.state
        published, self._refused = self._held.publishable(result, written)
        self.latest = published.state
        for answer in published.answers:
            self._answers.give(answer)
        self._subscribers.publish(published)

    def _commands(self) -> tuple[OperatorCommand, ...]:
        """Return the next commands; a change of the trial waits until the last is on the disk."""
        commands: list[OperatorCommand] = []
        if self._refused is not None:
            arguments = {"revision": self._held.safe.revision, "reason": self._refused}
            commands.append(OperatorCommand(RECORDING_FAILED, arguments))
        while self._arrived and len(commands) < COMMANDS_PER_TICK:
            command = self._arrived[0]
            changes_trial = command.name not in _STATELESS_COMMANDS
            if changes_trial and self._held.is_waiting:
                break
            self._arrived.popleft()
            if command.name == _BEGIN_REPLACEMENT:
                self.is_being_replaced = not self._is_trial_open
                reason = TRIAL_IS_OPEN if self._is_trial_open else ""
                self._answers.give(Answer(command.ticket, not reason, reason))
                continue
            if self._is_for_the_archive(command):
                self._query_archive(command)
                continue
            # The simulation itself reports an open trial.
            if command.name == CommandName.START_TASK and not self._is_trial_open:
                reason = BEING_SET_UP if self.is_being_replaced else ""
                if not reason and not self._starts.allows(self._state.sim_time):
                    reason = TOO_MANY_STARTS
                if reason:
                    self._answers.give(Answer(command.ticket, False, reason))
                    continue
            commands.append(command)
            if changes_trial:
                break
        return tuple(commands)

    @property
    def _is_trial_open(self) -> bool:
        return self._state.training.phase in OPEN_PHASES

    def _is_for_the_archive(self, command: OperatorCommand) -> bool:
        """Return whether a command is about a trial whose record is written, unless it ends it."""
        if command.name not in _ALLOWED_FOR_PAST_TRIALS:
            return False
        training = self._state.training
        if command.name not in REFUSALS:
            return True
        is_present = command.arguments["trialId"] == training.trial_id
        if command.name in ENDING_A_TRIAL:
            return not is_present
        return not is_present or training.phase in FINISHED_PHASES

    def _query_archive(self, command: OperatorCommand) -> None:
        at = Stamp.now(self._state.tick, self._state.sim_time)

        def query() -> None:
            try:
                data = self.archive.answer(command.name, command.arguments, at, command.sender)
            except RASTrainerError as error:
                # Not str(error), which would have no code.
                self._answers.give(Answer(command.ticket, False, error.args[0]))
            except Exception:
                _log.exception("%s of an older trial has failed", command.name)
                self._answers.give(Answer(command.ticket, False, ARCHIVE_FAILED))
            else:
                self._answers.give(Answer(command.ticket, True, data=data))

        self._writer.submit(query)

    def _finish(self) -> None:
        self._recorder.stop(self._state)
        self._writer.shutdown(wait=True)
        for answer in self._held.publishable(StepResult(self._state), None)[0].answers:
            self._answers.give(answer)
        self._answers.refuse_all(SHUTTING_DOWN)
