"""Procedures: how much of the target point error registration, hands and robot caused."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from typing import Any

import numpy as np
from markupsafe import Markup

from rastrainer.number_text import fixed
from rastrainer.procedure.errors import TrajectoryErrors
from rastrainer.protocol import PROCEDURE_PHASES
from rastrainer.study.study_data import StudyData
from rastrainer.trial import procedure_outcome
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import mean, rms

KINDS = {"biopsy": ("Biopsy", "#1b6ca8"), "dbs": ("DBS", "#c2571a"), "seeg": ("SEEG", "#3f8f4f")}
"""Title and color of each kind."""
PHASES = {"running": "touching", **{each.value: each.value for each in PROCEDURE_PHASES}}
"""Title of each phase."""
WHOLE, BY_REGISTRATION, BY_HAND = "mm", "by_registration_mm", "by_hand_mm"
"""Length of a target point error, and of its parts."""
LEAST_TRAINEES = 3
"""Fewer say nothing about others."""
Done = Sequence[tuple[TrialRow, ProcedureOutcome]]


def procedures(data: StudyData) -> Markup:
    """Return the section; "" without procedures that were scored."""
    done = [(trial, trial.procedure) for trial in data.trials if trial.procedure]
    if not done:
        return Markup()
    of_kind: dict[str, list[tuple[TrialRow, ProcedureOutcome]]] = {kind: [] for kind in KINDS}
    of_trainee: dict[str, list[tuple[TrialRow, ProcedureOutcome]]] = defaultdict(list)
    for trial, found in done:
        of_kind[found.analysis.kind].append((trial, found))
        of_trainee[trial.trainee].append((trial, found))
    own = [lines for one in of_trainee.values() if (lines := _lines(one, by_robot=False))]
    over_trainees = None
    if len(own) >= LEAST_TRAINEES:
        # Lines of a trainee are not independent.
        whole, registration, hand = (
            np.array([rms(_lengths(lines, part)) for lines in own])
            for part in (WHOLE, BY_REGISTRATION, BY_HAND)
        )
        over_trainees = {"spread": mean(whole), "difference": mean(registration - hand)}
    parts = {
        KINDS[kind]: (_lengths(lines, BY_REGISTRATION), _lengths(lines, BY_HAND))
        for kind, group in of_kind.items()
        if (lines := _lines(group, by_robot=False))
    }
    return render(
        "procedures",
        trials=len(data.trials),
        everything=_figures(done),
        kinds={KINDS[kind][0]: _figures(group) for kind, group in of_kind.items() if group},
        trainees={name: _figures(group) for name, group in sorted(of_trainee.items())},
        phases=list(PHASES.values()),
        over_trainees=over_trainees,
        compared=len(own),
        chart=charts.split_chart(parts) if parts else None,
        limits=procedure_outcome,
    )


def _lines(done: Done, by_robot: bool | None = None) -> list[TrajectoryErrors]:
    """Return the errors of lines; of those only whose guide the robot, or a hand, aligned."""
    lines = [line for _trial, found in done for line in found.analysis.trajectories]
    return lines if by_robot is None else [each for each in lines if each.self_aligned is by_robot]


def _lengths(lines: Sequence[TrajectoryErrors], part: str) -> np.ndarray:
    return np.array([getattr(line.target_point_error, part) for line in lines])


def _figures(done: Done) -> dict[str, Any]:
    def rms_text(lines: Sequence[TrajectoryErrors], part: str) -> str:
        return fixed(rms(_lengths(lines, part)), 2) if lines else "–"

    lines, by_hand, by_robot = (_lines(done, by_robot) for by_robot in (None, False, True))
    analyses = [found.analysis for _trial, found in done]
    kept_mm = [distance for line in lines for distance in line.kept_mm.values()]
    hits = sum(distance <= 0 for distance in kept_mm)
    times = [
        [analysis.duration_s for analysis in analyses],
        *([one.phase_times_s.get(phase, 0.0) for one in analyses] for phase in PHASES),
    ]
    return {
        "count": len(done),
        "trainees": len({trial.trainee for trial, _found in done}),
        "lines": len(lines),
        "by_hand": len(by_hand),
        "by_robot": len(by_robot),
        "target_errors": [
            rms_text(lines, WHOLE),
            rms_text(lines, BY_REGISTRATION),
            rms_text(by_hand, BY_HAND),
            rms_text(by_robot, BY_HAND),
        ],
        "other_errors": [
            fixed(rms([line.entry_point_error.mm for line in lines]), 2) if lines else "–",
            fixed(rms([line.angular_deviation_deg for line in lines]), 2),
            fixed(max((line.plunge_mm or 0.0 for line in lines), default=0.0), 1),
            f"{fixed(min(kept_mm), 1)} ({hits})" if kept_mm else "–",
        ],
        "hits": hits,
        "acceptable": sum(found.score.acceptable for _trial, found in done),
        "score": fixed(float(np.mean([found.score.score for _trial, found in done])), 1),
        "times": [fixed(float(np.mean(each)), 0) for each in times],
        "alignments": fixed(sum(each.alignments for each in analyses) / len(lines), 2),
    }
