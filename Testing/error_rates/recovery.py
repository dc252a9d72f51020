"""Whether a report recovers the parameters of simulated studies that follow a protocol."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from rastrainer.number_text import fixed
from rastrainer.protocol import FIDUCIAL_COUNT, StepKind
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM
from rastrainer.study.protocol.study_protocol import StudyProtocol, steps_for
from rastrainer.study.study_data import StudyData
from rastrainer.study_messages import StudyStep
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report.variation import StudyVariation, study_variation, view_bias
from rastrainer_simulator.statistics.intervals import Estimate
from rastrainer_simulator.virtual.outcome_model import DOF, OutcomeModel, draw
from rastrainer_simulator.virtual.population import pseudonym
from Testing.error_rates.measured import Measured, holds, share_of


@dataclass(frozen=True)
class DrawnTrials:
    """The drawn values; all arrays are (trainees, modes, tasks).

    Attributes:
        times_s: Completion times.
        errors_mm: RMSE of the registrations.
        true_tre_mm: True errors at a target in the middle of the points.
        lapses: Whether a touch was taken back.
    """

    times_s: np.ndarray
    errors_mm: np.ndarray
    true_tre_mm: np.ndarray
    lapses: np.ndarray


def draw_trials(
    model: OutcomeModel, modes: Sequence[str], random: np.random.Generator, numbers: np.ndarray
) -> DrawnTrials:
    """Return everything of a study's trials.

    Args:
        model: The truth.
        modes: Of the second axis of the arrays.
        random: Of the draws.
        numbers: (trainees, modes, tasks) int, which trial of the trainee's each is, from 1.
    """
    times, errors, fle, lapses = draw(model, modes, random, numbers)
    # In the middle of the points the expected TRE² is FLE²/N (Fitzpatrick 1998).
    sd = (fle / math.sqrt(3 * FIDUCIAL_COUNT))[..., None]
    offsets = random.normal(size=(*numbers.shape, 3)) * sd
    offsets[..., 0] += np.array([model.mode_bias_mm.get(mode, 0.0) for mode in modes])[:, None]
    return DrawnTrials(times, errors, np.linalg.norm(offsets, axis=-1), lapses)


def draw_protocol_study(
    model: OutcomeModel, protocol: StudyProtocol, trainees: int, random: np.random.Generator
) -> StudyData:
    """Return a simulated study whose modes and tasks follow the protocol's orders.

    Args:
        model: The true parameters, with the protocol's tasks.
        protocol: The protocol.
        trainees: Number of trainees.
        random: Random generator.
    """
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
    drawn = draw_trials(repeated, protocol.modes, random, numbers)
    rows = tuple(row for i in range(trainees) for row in _rows(protocol, i, drawn))
    return StudyData("Simulated outcomes", rows, has_order=True)


def _trials(protocol: StudyProtocol, trainee: int) -> Iterator[tuple[int, int, StudyStep]]:
    """Yield mode index, slot and step of each trial of a trainee, in order."""
    for step in steps_for(protocol, trainee):
        if step.kind is StepKind.TRIAL:
            round_ = int(step.name.split("/")[1]) - 1
            slot = round_ * len(protocol.tasks) + protocol.tasks.index(step.task)
            yield protocol.modes.index(step.mode), slot, step


def _rows(protocol: StudyProtocol, trainee: int, drawn: DrawnTrials) -> Iterator[TrialRow]:
    counts = dict.fromkeys(protocol.modes, 0)
    for mode, slot, step in _trials(protocol, trainee):
        counts[step.mode] += 1
        place = trainee, mode, slot
        rmse_mm = float(drawn.errors_mm[place])
        # In the middle of the points; see `draw_trials`.
        scatter = rmse_mm**2 / (1 - 2 / FIDUCIAL_COUNT) / FIDUCIAL_COUNT
        values = {
            "completion_time_s": float(drawn.times_s[place]),
            "rmse_mm": rmse_mm,
            "expected_tre_mm": math.sqrt(scatter + 3 * COMMON_BIAS_SD_MM**2),
            "tre_common_bias_sd_mm": COMMON_BIAS_SD_MM,
            "true_tre_mm": float(drawn.true_tre_mm[place]),
            "undone_touches": int(drawn.lapses[place]),
        }
        yield TrialRow(pseudonym(trainee), step.mode, step.task, counts[step.mode], values)


HEADER = ("parameter", "deviation, standard errors", "truth", "mean", "standard error")
COVERAGE_HEADER = ("parameter", "interval contains the truth")
MOST = 2.0
"""Standard errors; of 15 unbiased estimates one is off by more in every other table."""
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


@dataclass(frozen=True)
class Recovered:
    """One parameter: its true value, and the mean of its estimates over all data sets."""

    case: str
    truth: float
    mean: float
    standard_error: float
    at_most: float = MOST
    at_least: None = None

    @property
    def off(self) -> float:
        """Deviation of the mean from the true value, in standard errors."""
        return abs(self.mean - self.truth) / self.standard_error

    def holds(self, standard_errors: float = 0.0) -> bool:
        """Return whether it is at most 2 standard errors, or `standard_errors` if larger."""
        return self.off <= max(self.at_most, standard_errors)

    def cells(self) -> list[str]:
        """Return the row of a table."""
        numbers = (self.truth, self.mean, self.standard_error)
        asked = f"≤ {self.at_most:g}"
        return [self.case, fixed(self.off, 1), asked, *(fixed(number, 5) for number in numbers)]


def parameters(sets: int) -> list[Recovered]:
    """Return every parameter of the model, estimated from ten times `sets` studies."""
    found = np.array([[one.value for one in own] for own in _estimated(TIMES * sets)])
    errors = found.std(axis=0, ddof=1) / math.sqrt(len(found))
    return [
        Recovered(name, truth, float(mean), float(error))
        for (name, truth), mean, error in zip(
            truths().items(), found.mean(axis=0), errors, strict=True
        )
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
    assert found is not None
    return [*_of_outcomes(found), *_of_views(study)]


def _of_outcomes(found: StudyVariation) -> Iterator[Estimate]:
    time, error = found.time, found.error
    assert time.lapse is not None
    yield from (time.learning, error.learning, found.trade_off, *time.modes, *error.modes)
    for name in ("trainee_variance", "interaction_variance", "trial_variance"):
        yield from (getattr(time, name), getattr(error, name))
    yield Estimate(found.lapses.share, found.lapses.interval)
    yield time.lapse


def _of_views(study: StudyData) -> Iterator[Estimate]:
    for mode in PROTOCOL.modes:
        found = view_bias(study, mode)
        assert found is not None
        yield found.squared
