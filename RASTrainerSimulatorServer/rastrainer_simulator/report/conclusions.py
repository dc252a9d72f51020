"""The answers, what cannot be concluded, a methods paragraph for a paper, and the versions."""

from __future__ import annotations

import platform
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import scipy
from markupsafe import Markup

import rastrainer
from rastrainer.number_text import counted
from rastrainer.study.outcomes import FILTER, mode_title, task_title
from rastrainer.study.protocol.study_protocol import BALANCED
from rastrainer.study.study_data import StudyData
from rastrainer.trial import score_reference, scoring
from rastrainer_simulator.report.comparisons import ModeComparison, compared_method
from rastrainer_simulator.report.decisions import Decisions
from rastrainer_simulator.report.page import render
from rastrainer_simulator.report.passing import ModePassing
from rastrainer_simulator.report.target_errors import TITLES
from rastrainer_simulator.statistics.intervals import detectable_effect, subjects_needed

MAX_NAMED = 12
FEW_SUBJECTS = 20
"""The limits are always stated for fewer subjects."""


def answers(
    data: StudyData,
    comparisons: Sequence[ModeComparison],
    of_methods: Sequence[ModeComparison],
    passed: Sequence[ModePassing],
    left_out: Mapping[str, int],
    decided: Decisions | None,
) -> Markup:
    """Return the first screen: who passed, the differences shown, and the limits."""
    results = [one.result for one in comparisons if one.result is not None]
    n = max((len(comparison.trainees) for comparison in comparisons), default=0)
    with_period = any(result.sequences is not None for result in results)
    return render(
        "answers",
        data=data,
        has_score=any("score" in trial.values for trial in data.trials),
        passed=passed,
        most_named=MAX_NAMED,
        confirmatory=[one for one in comparisons if one.adjusted_p is not None],
        of_methods=[one for one in of_methods if one.adjusted_p is not None],
        titles=TITLES,
        has_results=bool(results),
        compared=n,
        few=FEW_SUBJECTS,
        are_few=0 < n < FEW_SUBJECTS,
        effect=detectable_effect(n, with_period) if results else None,
        with_period=with_period,
        is_order_known=any(comparison.order is not None for comparison in comparisons),
        method=compared_method(data),
        left_out=left_out,
        decided=decided,
    )


def left_out_methods(data: StudyData) -> dict[str, int]:
    started = [trial.method for trial in data.trials]
    started += [record.method.value for record in data.aborted]
    compared = compared_method(data)
    return dict(sorted(Counter(method for method in started if method != compared).items()))


def limits(data: StudyData, comparisons: Sequence[ModeComparison]) -> Markup:
    facts: dict[str, Any] = {"n": None}
    if comparisons:
        largest = max(comparisons, key=lambda one: (one.result is not None, len(one.trainees)))
        n, result = len(largest.trainees), largest.result
        with_period = result is not None and result.sequences is not None
        sizes = (0.2, 0.5, 0.8) if n < FEW_SUBJECTS else ()
        facts = {
            "n": n,
            "effect": detectable_effect(n, with_period) if n > 1 else None,
            "with_period": with_period,
            "is_order_known": largest.order is not None,
            "smallest_p": result.ranks.smallest_p if result and result.ranks else None,
            "needed": [subjects_needed(size, with_period) for size in sizes],
        }
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
        **facts,
        data=data,
        lacking=lacking,
        paused=paused,
        long_pause_s=scoring.LONG_PAUSE_S,
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
