"""A model of what trials give, without the physics: thousands of studies in a second.

Completion time and registration error of a trial are drawn from the distributions that the theory
gives: times log-normal about task, trainee, mode and practice; errors as the FRE of fifteen points
whose localization error depends on task, trainee and mode (FRE² = FLE²·(1 − 2/N)·χ²/dof). What is
estimated from such data can be compared with what was put in. It is not the simulator: hands, arm
and head play no part.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from rastrainer.cohort.jobs import pseudonym
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.report.study_data import StudyData, TrialRow

DOF = 3 * FIDUCIAL_COUNT - 6


@dataclass(frozen=True)
class OutcomeModel:
    """The truth of a simulated study.

    Attributes:
        task_times_s: Median completion time of each task at the first trial in the first mode.
        task_fle_mm: Localization error of each task, the same length.
        trainee_time_sd: Between trainees, of the logarithm of the time.
        trainee_fle_sd: Between trainees, of the logarithm of the localization error.
        interaction_sd: How differently modes affect trainees, of both logarithms.
        trial_time_sd: Between trials of a trainee, of the logarithm of the time.
        learning: b; the n-th trial in a mode takes n^−b of the first one's time.
        mode_time: Factor on the time in each mode; 1 for those left out.
        mode_fle: Factor on the localization error in each mode.
    """

    task_times_s: Sequence[float]
    task_fle_mm: Sequence[float]
    trainee_time_sd: float = 0.15
    trainee_fle_sd: float = 0.15
    interaction_sd: float = 0.05
    trial_time_sd: float = 0.12
    learning: float = 0.1
    mode_time: Mapping[str, float] = field(default_factory=dict)
    mode_fle: Mapping[str, float] = field(default_factory=dict)


def draw_study(
    model: OutcomeModel, trainees: int, modes: Sequence[str], random: np.random.Generator
) -> StudyData:
    """Return a study in which every trainee does every task once in every mode."""
    times, errors = draw_outcomes(model, trainees, modes, random)
    rows = [
        TrialRow(
            pseudonym(i),
            mode,
            f"task-{k + 1}",
            k + 1,
            {"completion_time_s": float(times[i, m, k]), "rmse_mm": float(errors[i, m, k])},
        )
        for i in range(trainees)
        for m, mode in enumerate(modes)
        for k in range(len(model.task_times_s))
    ]
    return StudyData("Simulated outcomes", tuple(rows), has_order=True)


def draw_outcomes(
    model: OutcomeModel, trainees: int, modes: Sequence[str], random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return times in s and RMSE in mm, both (trainees, modes, tasks) float."""
    tasks = len(model.task_times_s)
    shape = (trainees, len(modes), tasks)
    own_time, own_fle = (
        random.normal(0, sd, (trainees, 1, 1))
        + random.normal(0, model.interaction_sd, (trainees, len(modes), 1))
        for sd in (model.trainee_time_sd, model.trainee_fle_sd)
    )
    median_times, median_fle = _medians(model, modes)
    times = median_times * np.exp(own_time + random.normal(0, model.trial_time_sd, shape))
    fle = median_fle * np.exp(own_fle)
    # The expected FRE² is FLE²·(1 − 2/N), and 3N − 6 residuals are left after a rigid fit.
    squares = fle**2 * (1 - 2 / FIDUCIAL_COUNT) * random.chisquare(DOF, shape) / DOF
    return times, np.sqrt(squares)


def expected_outcomes(model: OutcomeModel, modes: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the means that very many trainees have: times in s and RMSE in mm, (modes, tasks).

    A log-normal's mean is exp(σ²/2) times its median; that of χ is √2·Γ((k + 1)/2)/Γ(k/2).
    """
    times, fle = _medians(model, modes)
    time_sds = (model.trainee_time_sd, model.interaction_sd, model.trial_time_sd)
    fle_sds = (model.trainee_fle_sd, model.interaction_sd)
    of_time, of_fle = (math.exp(sum(sd**2 for sd in sds) / 2) for sds in (time_sds, fle_sds))
    chi = math.sqrt(2) * math.exp(math.lgamma((DOF + 1) / 2) - math.lgamma(DOF / 2))
    return times * of_time, fle * of_fle * math.sqrt((1 - 2 / FIDUCIAL_COUNT) / DOF) * chi


def _medians(model: OutcomeModel, modes: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return time in s and localization error in mm of the typical trainee, (modes, tasks)."""
    mode_time, mode_fle = (
        np.array([factors.get(mode, 1.0) for mode in modes])[:, None]
        for factors in (model.mode_time, model.mode_fle)
    )
    practice = np.arange(1, len(model.task_times_s) + 1) ** -model.learning
    times = mode_time * np.asarray(model.task_times_s) * practice
    return times, mode_fle * np.asarray(model.task_fle_mm)
