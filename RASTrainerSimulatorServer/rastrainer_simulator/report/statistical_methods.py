"""What cannot be concluded, a methods paragraph for a paper, the references and the versions."""

from __future__ import annotations

import platform
from collections.abc import Sequence

import numpy as np
import scipy
from markupsafe import Markup

import rastrainer
from rastrainer.number_text import counted, p_text, percent
from rastrainer.study.outcomes import FILTER, mode_title, task_title
from rastrainer.study.protocol.study_protocol import BALANCED
from rastrainer.study.study_data import StudyData
from rastrainer.trial import score_reference, scoring
from rastrainer_simulator.report.comparisons import ModeComparison, compared_method
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import (
    ALPHA,
    TARGET_POWER,
    detectable_effect,
    subjects_needed,
)
from rastrainer_simulator.statistics.paired import PairedComparison

FEW_SUBJECTS = 20
"""The limits are always stated for fewer subjects."""


def limits(data: StudyData, comparisons: Sequence[ModeComparison]) -> Markup:
    sentences = ["No trainee did two modes: nothing is said about their difference."]
    if comparisons:
        largest = max(comparisons, key=lambda one: (one.result is not None, len(one.trainees)))
        sentences = what_cannot_be_concluded(
            len(largest.trainees), largest.result, largest.order is not None
        )
    paused = sum(
        trial.values.get("pause_time_s", 0.0) > scoring.LONG_PAUSE_S for trial in data.trials
    )
    # Means over different tasks cannot be compared.
    lacking = []
    for mode in data.modes:
        own = data.of_mode(mode)
        trainees = {trial.trainee for trial in own}
        for task in data.tasks:
            missing = len(trainees) - len({t.trainee for t in own if t.task == task})
            if missing:
                who = f"{missing} of {counted(len(trainees), 'trainee')}"
                lacking.append(f"{task_title(task)}, {mode_title(mode)}, of {who}")
    return render(
        "limits",
        data=data,
        sentences=sentences,
        lacking=lacking,
        paused=paused,
        long_pause_s=scoring.LONG_PAUSE_S,
    )


def what_cannot_be_concluded(
    n: int, comparison: PairedComparison | None = None, order_known: bool = True
) -> list[str]:
    """Return what a paired comparison of n subjects cannot show, in sentences."""
    if n < 2:
        return ["One subject allows no comparison: nothing can be said of anyone else."]
    with_period = comparison is not None and comparison.sequences is not None
    sentences = [
        f"{what_is_detected(n, with_period)} Smaller ones are missed more often, and where one is "
        "found, its size tends to be overestimated."
    ]
    smallest = None
    if comparison is not None and comparison.ranks is not None:
        smallest = comparison.ranks.smallest_p
    if smallest is not None and smallest > ALPHA:
        name = "rank-sum" if with_period else "signed-rank"
        sentences.append(
            f"Wilcoxon's {name} test cannot reach the {percent(ALPHA)} level with {n} "
            f"subjects at all: its smallest possible p is {p_text(smallest)}."
        )
    if n < FEW_SUBJECTS:
        small, medium, large = (
            subjects_needed(size, with_period=with_period) for size in (0.2, 0.5, 0.8)
        )
        sentences += [
            f"To find a small, medium or large effect (d_z of 0.2, 0.5 or 0.8) as reliably, "
            f"{small}, {medium} or {large} subjects are needed.",
            "Whether the differences are normally distributed cannot be checked with so few.",
        ]
    return [*sentences, _about_order(with_period, order_known)]


def what_is_detected(n: int, with_period: bool) -> str:
    """Return how large a difference n subjects can show; n is at least 2."""
    effect = detectable_effect(n, with_period=with_period)
    test = "a t-test with the period" if with_period else "a paired t-test"
    return (
        f"With {n} subjects, {test} at the {percent(ALPHA)} level finds a true difference "
        f"in {percent(TARGET_POWER)} of studies only if it is at least {effect:.1f} times the "
        "standard deviation of the subjects' differences."
    )


def _about_order(with_period: bool, order_known: bool) -> str:
    if with_period:
        return (
            "What one condition leaves behind for the next one (carry-over) cannot be separated "
            "from the difference of the conditions where it is not equal in both directions. The "
            "analysis assumes that it is equal; the comparison of the sequences would show only a "
            "large inequality, and finding none proves nothing."
        )
    if not order_known:
        return (
            "Which condition the subjects did first is not in the data: practice and fatigue "
            "cannot be separated from the difference of the conditions, whatever the tests say."
        )
    return (
        "The subjects' orders of the conditions do not allow the effect of the period to be "
        "separated: practice and fatigue are part of the difference of the conditions. Only "
        "different orders, of four subjects or more, separate them."
    )


def methods(data: StudyData) -> Markup:
    return render(
        "methods",
        data=data,
        is_balanced=lambda order: order == BALANCED,
        found={name for trial in data.trials for name in trial.values},
        motion_filter=FILTER,
        method=compared_method(data),
        scoring=scoring,
        reference=score_reference,
        version=rastrainer.__version__,
        libraries=f"{platform.python_version()}, {np.__version__}, {scipy.__version__}",
    )
