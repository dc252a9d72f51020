"""Drills as rows: for progress, reports and tables."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_score import DRILL_SCORE_VERSION, drill_score
from rastrainer.trial.trial_row import TrialRow


def drill_rows(drills: Iterable[DrillRecord]) -> list[TrialRow]:
    """Return drills as trials are: numbered for each trainee, acceptable if passed."""
    counts: Counter[str] = Counter()
    rows = []
    for drill in drills:
        counts[drill.trainee] += 1
        score = drill_score(drill.cases)
        values = {
            "completion_time_s": sum(case.time_s for case in drill.cases),
            "score": score.score,
            "sensitivity": score.sensitivity.value,
            "criterion": score.criterion.value,
            "mean_cost": score.mean_cost,
            "brier": score.brier,
            "ability_logits": score.ability.value,
            "mean_checks": score.mean_checks,
            "harmful": float(score.harmful),
            "vain": float(score.vain),
        }
        rows.append(
            TrialRow(
                *(drill.trainee, drill.mode, drill.task, counts[drill.trainee], values),
                *(drill.trial_id, drill.started_utc, drill.scenario, DRILL_SCORE_VERSION),
                acceptable=score.is_passed,
                completed_utc=drill.completed_utc,
                method="",
            )
        )
    return rows
