"""A cohort that is really played with all effects at once, and the estimates of its report.

`played_cohort.csv` has the numbers of the report. `python -m Testing.error_rates.cohort FOLDER`
plays the study into a folder, some seconds a trial, and writes the file; an interrupted study
resumes.
"""

from __future__ import annotations

import functools
import math
import sys
from collections import defaultdict
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.number_text import fixed
from rastrainer.registration.registration import register
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.study.study_data import StudyData, read_study_data
from rastrainer.trial.score_reference import fiducial_normals
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO
from rastrainer_simulator.virtual.cohort import DATABASE, simulate_cohort
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import PlaySettings
from rastrainer_simulator.virtual.population import ModeEffect, Population, trial_jobs
from Testing.error_rates.hands import HEADS, USUAL, trials_of
from Testing.error_rates.measured import Measured, deviation
from Testing.error_rates.recovery import PROTOCOL, estimates, truths
from Testing.error_rates.row_files import add_row, stored_rows

STUDY_PROTOCOL = replace(PROTOCOL, name="known-truth", title="A cohort whose truth is known")
FILE = Path(__file__).with_name("played_cohort.csv")
TRAINEES, SEED = 40, 5
POPULATION = Population(
    skill=Skill(),
    speed_spread=0.15,
    aim_spread=0.15,
    learning=0.15,
    modes={"hmd": ModeEffect(speed=0.9, aim=1.2, bias_mm=(0.6, 0.5, 0.6))},
    accuracy_learning=0.1,
    interaction=0.1,
    tempo_spread=0.25,
    trade_off=0.5,
    lapses=0.2,
)
HEADER = (
    "parameter",
    "deviation, standard errors",
    "truth",
    "estimate",
    "95 % interval",
    "contains the truth",
)


def recovered(_sets: int = 0) -> list[Measured]:
    """Return the parameters that were asked for, as the report of the stored cohort gives them.

    Standard errors come from the interval on the truth's side. In about half of such cohorts, one
    of 13 estimates is off by more than two by chance.
    """
    found = dict(zip(truths(), estimates(stored_cohort()), strict=True))
    rows = []
    for name, truth in asked_for().items():
        value, (low, high) = found[name].value, found[name].interval
        reach = value - low if truth < value else high - value
        numbers = fixed(truth, 4), fixed(value, 4), f"{fixed(low, 4)} to {fixed(high, 4)}"
        is_held = "yes" if low <= truth <= high else "no"
        rows.append(deviation(name, truth, value, reach / 1.96, (*numbers, is_held)))
    return rows


@functools.cache
def asked_for() -> dict[str, float]:
    """Return the true values, by the names of `truths`.

    Values that no option sets are omitted: the time of a lapse, and the errors that hands and arm
    add from trial to trial. The RMSE grows by more than the scatter with the headset: touches
    stay on the skin, so no rigid motion explains the whole bias of a view.
    """
    effect, (displaced, left) = POPULATION.modes["hmd"], _effects_of_views()
    return {
        "practice, time: b": POPULATION.learning,
        "practice, accuracy: b": POPULATION.accuracy_learning,
        "speed and accuracy: k": POPULATION.trade_off,
        "headset, time: ln factor": -math.log(effect.speed),
        "headset, localization error: ln factor": math.log(effect.aim) + left["hmd"],
        "between trainees, time: SD²": POPULATION.speed_spread**2,
        "between trainees, accuracy: SD²": POPULATION.aim_spread**2,
        "trainee × mode, time: SD²": POPULATION.interaction**2,
        "trainee × mode, accuracy: SD²": POPULATION.interaction**2,
        "from trial to trial, time: SD²": POPULATION.tempo_spread**2,
        "lapses: share of trials": float(POPULATION.lapses or 0.0),
        **{f"bias of the view, {mode}: mm²": square for mode, square in displaced.items()},
    }


def _effects_of_views() -> tuple[dict[str, float], dict[str, float]]:
    """Return the effects of each mode's bias.

    The first is the mean square of the target's displacement, mm². The second is the increase of
    the mean logarithm of the RMSE of touches that scatter like the hands of the trial.
    """
    squares, added = defaultdict(list), defaultdict(list)
    for job in trial_jobs(STUDY_PROTOCOL, POPULATION, TRAINEES, SEED):
        displaced, left = _alone(job.task, job.seed, np.array(job.skill.aim_bias_mm))
        scatter = job.skill.aim_sd_mm / POPULATION.skill.aim_sd_mm
        squares[job.mode].append(displaced**2)
        added[job.mode].append(0.5 * math.log1p((left / scatter / _usual_fre(job.task)) ** 2))
    return tuple(
        {mode: float(np.mean(values[mode])) for mode in PROTOCOL.modes}
        for values in (squares, added)
    )


def _alone(task: str, seed: int, bias_mm: np.ndarray) -> tuple[float, float]:
    """Return the target's displacement and the FRE, mm, if all touches are off by a bias alone."""
    scenario = _scenario()
    head_to_world = scenario.perturbed_head_to_world(seed)
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    normals = fiducial_normals(scenario, task) @ head_to_world[:3, :3].T
    # Errors perpendicular to the skin move no touch.
    along = bias_mm - normals * (normals @ bias_mm)[:, None]
    fit = register(transforms.apply(head_to_world, fiducials) + along, fiducials)
    target = scenario.target.position_ras[None]
    there = transforms.apply(fit.matrix @ head_to_world, target)
    return float(np.linalg.norm(there - target)), fit.fre_mm


@functools.cache
def _usual_fre(task: str) -> float:
    """Return the FRE of the usual hands on a task, mm, RMS over their trials."""
    fiducials = np.asarray(_scenario().task(task).fiducials, dtype=float)
    trials = trials_of(USUAL, HEADS[0], task)
    squares = [register(fiducials + one.errors_mm, fiducials).fre_mm ** 2 for one in trials]
    return float(np.sqrt(np.mean(squares)))


@functools.cache
def _scenario() -> Scenario:
    return load_scenario(asset_path(*DEFAULT_SCENARIO))


@dataclass(frozen=True)
class Row:
    """One trial of the cohort."""

    trainee: str
    mode: str
    task: str
    number: int
    completion_time_s: float
    rmse_mm: float
    true_tre_mm: float
    expected_tre_mm: float
    tre_common_bias_sd_mm: float
    undone_touches: float


VALUES = [field.name for field in fields(Row)][4:]


@functools.cache
def stored_cohort() -> StudyData:
    rows = (
        (astuple(row)[:4], {name: getattr(row, name) for name in VALUES})
        for row in stored_rows(FILE, Row)
    )
    trials = tuple(TrialRow(*place, values) for place, values in rows)
    return StudyData("A played cohort", trials, has_order=True)


def play_cohort(folder: Path, workers: int | None = None) -> StudyData:
    """Play the whole study, or the rest of it, into a folder."""
    run = simulate_cohort(
        STUDY_PROTOCOL, POPULATION, TRAINEES, SEED, folder, PlaySettings(), workers=workers
    )
    assert run.stuck == 0, "A trainee got stuck."
    return read_study_data(folder / DATABASE)


if __name__ == "__main__":
    found = play_cohort(Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else None)
    FILE.unlink(missing_ok=True)
    for one in found.trials:
        values = (round(one.values[name], 4) for name in VALUES)
        add_row(FILE, Row(one.trainee, one.mode, one.task, one.number, *values))
