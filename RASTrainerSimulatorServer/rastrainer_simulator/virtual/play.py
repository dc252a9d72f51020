"""Play one trial with the whole simulation, faster than real time, from the arm to the score."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.commands import CommandName, check_arguments
from rastrainer.head.mesh import read_head_mesh
from rastrainer.journal.entries import AT_ZERO, Line, iso
from rastrainer.journal.folder import SUFFIX
from rastrainer.journal.journal_file import file_stamp
from rastrainer.procedure.record import ProcedureRecord, UsedRegistration
from rastrainer.protocol import Mode, Phase, Proximity
from rastrainer.registration.fits import RIGID
from rastrainer.registration.target_error import true_target_error_mm
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import ScoreReference
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.record.trial_records import UnmeasuredRecord, with_record
from rastrainer_simulator.state import (
    NEUTRAL_STICKS,
    OperatorCommand,
    OperatorInput,
    SimulationState,
    StepResult,
)
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.population import TrialJob
from rastrainer_simulator.virtual.scripted_trainee import (
    LONGEST_TRIAL_S,
    Action,
    Observation,
    ScriptedTrainee,
    TrialStoppedError,
)
from rastrainer_simulator.virtual.virtual_procedure import ProcedureHands, VirtualProcedure

OnStep = Callable[[Simulation, SimulationState, OperatorInput, StepResult], Any]
"""Called with the simulation, the state before, the input and the result of each step."""


def play_virtual_trial(
    simulation: Simulation,
    task_name: str,
    seed: int,
    skill: Skill,
    dt: float,
    on_step: OnStep | None = None,
    trainee: str | None = None,
    mode: Mode = Mode.DESKTOP,
    trial_id: str | None = None,
) -> None:
    """Play one task to its registration; the simulation is left in the phase `registered`.

    The mode goes into the record; the hands do not see it.
    """
    scenario = simulation.setup.scenario
    head_to_world = scenario.perturbed_head_to_world(seed)
    hands = ScriptedTrainee(scenario, task_name, head_to_world, skill, seed, dt)
    name = trainee or f"virtual-{seed}"
    start = {"task": task_name, "trainee": name, "mode": mode.value, "seed": seed}

    def step(action: Action | None, **own: Any) -> StepResult:
        before, operator_input = simulation.state, NEUTRAL_STICKS
        if action is not None:
            name, arguments = action
            # `own` are arguments that no client may send.
            command = OperatorCommand(name, {**check_arguments(name, arguments), **own})
            operator_input = OperatorInput(commands=(command,))
        result = simulation.step(dt, operator_input)
        if on_step is not None:
            on_step(simulation, before, operator_input, result)
        return result

    own = {} if trial_id is None else {"trialId": trial_id}
    state = step((CommandName.START_TASK, start), **own).state
    while state.training.phase is not Phase.REGISTERED:
        if state.elapsed > LONGEST_TRIAL_S:
            raise TrialStoppedError(
                f"The scripted trainee of seed {seed} did not finish {task_name} in "
                f"{LONGEST_TRIAL_S:g} s: it is at point {state.training.next_point}."
            )
        seen = Observation(
            sim_time_s=state.sim_time,
            tip_mm=MM_PER_M * state.tool_tip_to_world[:3, 3],
            is_in_contact=state.proximity is Proximity.CONTACT,
            phase=state.training.phase,
            next_point=int(state.training.next_point or 0),
        )
        action = hands.decide(seen)
        result = step(action)
        state = result.state
        if action is not None and action[0] == CommandName.CAPTURE and not result.answers[0].ok:
            hands.touch_refused()


STEP_S = 0.05
PROCEDURE_STREAM = 21
"""Random stream of procedures; touches have their own."""


@dataclass(frozen=True)
class PlaySettings:
    """How the jobs of a cohort are played; `records` is the folder for the journals.

    `references` score each task; the scenario's references score the tasks that they leave out.
    """

    scenario: Path | None = None
    step_s: float = STEP_S
    references: Mapping[str, ScoreReference] | None = None
    records: Path | None = None


@dataclass(frozen=True)
class PlayedTrial:
    """The result of a job; `analysis` is None if the trainee got stuck."""

    job: TrialJob
    analysis: TrialAnalysis | None


def play_job(job: TrialJob, settings: PlaySettings) -> PlayedTrial:
    """Play, register and score one trial; equal jobs give equal trials on any machine."""
    simulation = _simulation(settings.scenario)
    # The trial depends on the job alone, not on the trial before.
    simulation.restart_from(AT_ZERO)
    started: list[TrialEntries] = []
    registered: list[UnmeasuredRecord] = []

    def record_step(
        _: Simulation, before: SimulationState, sticks: OperatorInput, result: StepResult
    ) -> None:
        if not started:
            started.append(TrialEntries.started(simulation, before, result, settings.step_s))
        record = started[0].add(simulation, sticks, result)
        if record is not None:
            registered.append(record)

    try:
        play_virtual_trial(
            *(simulation, job.task, job.seed, job.skill, settings.step_s, record_step),
            *(job.trainee, Mode(job.mode), job.trial_id),
        )
    except TrialStoppedError:
        # The next trial needs a simulation without an open trial.
        _simulation.cache_clear()
        return PlayedTrial(job, None)
    lines, record = _dated(started[0].pending, registered[0].measured(), job.started)
    if settings.records is not None:
        name = f"{file_stamp(iso(job.started))}_{job.trial_id}{SUFFIX}"
        # Complete or missing, even if this process is killed; the journal of a trial that was not
        # stored is replaced by an equal one.
        partial = settings.records / f".{name}.partial"
        partial.unlink(missing_ok=True)
        journal = Journal(partial)
        journal.write_lines(lines, sync=False)
        journal.close()
        partial.replace(settings.records / name)
    scenario = simulation.setup.scenario
    head_to_world = scenario.perturbed_head_to_world(job.seed)
    analysis = analyze_trial(record, scenario)
    target = scenario.target.position_ras
    tre_mm = true_target_error_mm(analysis.rigid.matrix, head_to_world, target)
    truth = RevealedTruth(tuple(head_to_world.ravel().tolist()), tre_mm)
    if job.procedure:
        done = _procedure(job, analysis, scenario, head_to_world)
        analysis = replace(analysis, record=replace(record, procedure=done))
    return PlayedTrial(job, analysis.scored(scenario, truth, settings.references))


def _procedure(
    job: TrialJob, analysis: TrialAnalysis, scenario: Scenario, head_to_world: np.ndarray
) -> ProcedureRecord:
    """Return what the job's hands did after the registration."""
    procedure, skull = scenario.procedure(job.procedure), scenario.skull_path
    matrix = tuple(analysis.rigid.matrix.ravel().tolist())
    return VirtualProcedure(
        procedure,
        _skull(skull),
        procedure.sha256(skull),
        head_to_world,
        UsedRegistration(matrix, analysis.rigid.fre_mm, analysis.target_errors[RIGID].expected_mm),
        analysis.record.completion_time_s,
        ProcedureHands.of(job.skill),
        np.random.default_rng([job.seed, PROCEDURE_STREAM]),
    ).carried_out()


def _dated(
    lines: Sequence[Line], record: TrialRecord, started: datetime
) -> tuple[list[Line], TrialRecord]:
    """Return lines and record with dates from the trial's start, in simulated time."""
    zero = lines[0].at.sim_time_s

    def utc(sim_time: float) -> str:
        return iso(started + timedelta(seconds=sim_time - zero))

    points = tuple(replace(point, utc=utc(point.sim_time_s)) for point in record.points)
    record = replace(
        record,
        points=points,
        started_utc=utc(zero),
        completed_utc=points[-1].utc,
        # A virtual trainee plays as fast as the machine can, in no simulator.
        played=None,
    )
    dated = (Line(replace(at, utc=utc(at.sim_time_s)), entry) for at, entry in lines)
    return with_record(dated, record), record


_skull = functools.lru_cache(maxsize=1)(read_head_mesh)
"""Returns the skull of this process's scenario, which is read once."""


@functools.lru_cache(maxsize=1)
def _simulation(scenario: Path | None) -> Simulation:
    """Return this process's simulation, which is made once."""
    return Simulation(load_setup(scenario), seed=0)
