"""Whether a report recovers the parameters of simulated studies that follow a protocol."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy import special

from rastrainer.number_text import fixed
from rastrainer.protocol import FIDUCIAL_COUNT, StepKind
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM
from rastrainer.study.protocol.study_protocol import StudyProtocol, steps_for
from rastrainer.study.study_data import StudyData
from rastrainer.study_messages import StudyStep
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report.variation import study_variation, view_bias
from rastrainer_simulator.statistics.intervals import Estimate
from rastrainer_simulator.virtual.outcome_model import DOF, OutcomeModel, draw
from rastrainer_simulator.virtual.population import pseudonym
from Testing.error_rates.measured import Measured, deviation, holds, share_of


def draw_protocol_study(
    model: OutcomeModel, protocol: StudyProtocol, trainees: int, random: np.random.Generator
) -> StudyData:
    """Return a simulated study whose modes and tasks follow the protocol's orders."""
    rounds = protocol.repetitions
    repeated = replace(
        model,
        task_times_s=list(model.task_times_s) * rounds,
        task_fle_mm=list(model.task_fle_mm) * rounds,
    )
    shape = (trainees, len(protocol.modes), len(protocol.tasks) * rounds)
    numbers = np.zeros(shape, dtype=int)
    for trainee in range(trainees):
        for number, (mode, slot, _step) in enumerate(_trials(protocol, trainee), start=1):
            numbers[trainee, mode, slot] = number
    times, errors, fle, lapses = draw(repeated, protocol.modes, random, numbers)
    # In the middle of the points the expected TRE² is FLE²/N (Fitzpatrick 1998).
    offsets = random.normal(size=(*shape, 3)) * (fle / math.sqrt(3 * FIDUCIAL_COUNT))[..., None]
    biases = [model.mode_bias_mm.get(mode, 0.0) for mode in protocol.modes]
    offsets[..., 0] += np.array(biases)[:, None]
    scatter = errors**2 / (1 - 2 / FIDUCIAL_COUNT) / FIDUCIAL_COUNT
    drawn = {
        "completion_time_s": times,
        "rmse_mm": errors,
        "expected_tre_mm": np.sqrt(scatter + 3 * COMMON_BIAS_SD_MM**2),
        "tre_common_bias_sd_mm": np.full(shape, COMMON_BIAS_SD_MM),
        "true_tre_mm": np.linalg.norm(offsets, axis=-1),
        "undone_touches": lapses.astype(int),
    }
    rows = tuple(row for i in range(trainees) for row in _rows(protocol, i, drawn))
    return StudyData("Simulated outcomes", rows, has_order=True)


def _trials(protocol: StudyProtocol, trainee: int) -> Iterator[tuple[int, int, StudyStep]]:
    """Yield mode index, slot and step of each trial of a trainee, in order."""
    for step in steps_for(protocol, trainee):
        if step.kind is StepKind.TRIAL:
            round_ = int(step.name.split("/")[1]) - 1
            slot = round_ * len(protocol.tasks) + protocol.tasks.index(step.task)
            yield protocol.modes.index(step.mode), slot, step


def _rows(
    protocol: StudyProtocol, trainee: int, drawn: dict[str, np.ndarray]
) -> Iterator[TrialRow]:
    counts = dict.fromkeys(protocol.modes, 0)
    for mode, slot, step in _trials(protocol, trainee):
        counts[step.mode] += 1
        values = {name: of_all[trainee, mode, slot].item() for name, of_all in drawn.items()}
        yield TrialRow(pseudonym(trainee), step.mode, step.task, counts[step.mode], values)


HEADER = ("parameter", "deviation, standard errors", "truth", "mean", "standard error")
COVERAGE_HEADER = ("parameter", "interval contains the truth")
TIMES = 10
"""More data sets than in other tables: they are quick, and the standard errors a third as large."""
TRAINEES = 12
PROTOCOL = StudyProtocol(
    "recovery",
    "Recovery",
    ("desktop", "hmd"),
    "balanced",
    ("task-1", "task-2", "task-3", "task-4", "task-5"),
    "balanced",
)
MODEL = OutcomeModel(
    task_times_s=[105.0, 125.0, 130.0, 135.0, 140.0],
    task_fle_mm=[1.2, 1.4, 1.5, 1.6, 1.8],
    learning=0.15,
    accuracy_learning=0.08,
    trade_off=0.5,
    carries_practice=True,
    mode_time={"hmd": 1.1},
    mode_fle={"hmd": 1.2},
    lapses=0.2,
    lapse_time=1.05,
    mode_bias_mm={"desktop": 0.5, "hmd": 1.0},
)


def parameters(sets: int) -> list[Measured]:
    """Return every parameter of the model, estimated from ten times `sets` studies."""
    found = np.array([[one.value for one in own] for own in _estimated(TIMES * sets)])
    means, errors = found.mean(axis=0), found.std(axis=0, ddof=1) / math.sqrt(len(found))
    return [
        deviation(name, truth, mean, error, tuple(fixed(each, 5) for each in (truth, mean, error)))
        for (name, truth), mean, error in zip(truths().items(), means, errors, strict=True)
    ]


def coverage(sets: int) -> list[Measured]:
    """Return how often the interval of each parameter contains it, in the same studies."""
    found = _estimated(TIMES * sets)
    return [
        Measured(
            name,
            share_of([holds(own[place].interval, truth) for own in found]),
            len(found),
            None,
            0.94,
        )
        for place, (name, truth) in enumerate(truths().items())
    ]


@functools.lru_cache(maxsize=1)
def _estimated(sets: int, seed: int = 9) -> list[list[Estimate]]:
    """Return the estimates of every parameter, in the order of the truths, of each study."""
    random = np.random.default_rng(seed)
    drawn = (draw_protocol_study(MODEL, PROTOCOL, TRAINEES, random) for _ in range(sets))
    return [estimates(study) for study in drawn]


def truths() -> dict[str, float]:
    """Return the true value of each estimate; squared, because standard deviations are biased."""
    of_residual = float(special.polygamma(1, DOF / 2)) / 4
    haste = MODEL.trial_time_sd
    return {
        "practice, time: b": MODEL.learning,
        "practice, accuracy: b": MODEL.accuracy_learning,
        "speed and accuracy: k": MODEL.trade_off,
        "headset, time: ln factor": math.log(MODEL.mode_time["hmd"]),
        "headset, localization error: ln factor": math.log(MODEL.mode_fle["hmd"]),
        "between trainees, time: SD²": MODEL.trainee_time_sd**2,
        "between trainees, accuracy: SD²": MODEL.trainee_fle_sd**2,
        "trainee × mode, time: SD²": MODEL.interaction_sd**2,
        "trainee × mode, accuracy: SD²": MODEL.interaction_sd**2,
        "from trial to trial, time: SD²": haste**2,
        "from trial to trial, RMSE: SD²": (MODEL.trade_off * haste) ** 2 + of_residual,
        "lapses: share of trials": MODEL.lapses,
        "lapses, time: ln factor": math.log(MODEL.lapse_time),
        **{
            f"bias of the view, {mode}: mm²": MODEL.mode_bias_mm[mode] ** 2
            for mode in PROTOCOL.modes
        },
    }


def estimates(study: StudyData) -> list[Estimate]:
    """Return what the report of a study tabulates, in the order of the truths."""
    found = study_variation(study)
    time, error = found.time, found.error
    names = ("trainee_variance", "interaction_variance", "trial_variance")
    return [
        *(time.learning, error.learning, found.trade_off, *time.modes, *error.modes),
        *(getattr(each, name) for name in names for each in (time, error)),
        Estimate(found.lapses.share, found.lapses.interval),
        time.lapse,
        *(view_bias(study, mode).squared for mode in PROTOCOL.modes),
    ]
