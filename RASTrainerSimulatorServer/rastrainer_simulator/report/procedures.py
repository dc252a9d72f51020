"""Procedures: how much of the target point error registration, hands and robot caused."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from markupsafe import Markup

from rastrainer.number_text import fixed
from rastrainer.procedure.errors import TrajectoryErrors
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.trial import procedure_outcome
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import mean, rms

KINDS = {
    "biopsy": ("Biopsy", "#1b6ca8"),
    "dbs": ("DBS", "#c2571a"),
    "seeg": ("SEEG", "#3f8f4f"),
}
"""Title and color of each kind."""
PHASES = {
    "running": "touching",
    "verifying": "verifying",
    "aligning": "aligning",
    "drilling": "drilling",
    "inserting": "inserting",
}
"""Title of each phase."""
TARGET = "target_point_error"
WHOLE, BY_REGISTRATION, BY_HAND = "mm", "by_registration_mm", "by_hand_mm"
"""Length of an error, and of its parts."""
LEAST_TRAINEES = 3
"""Fewer say nothing about others."""


@dataclass(frozen=True)
class ProcedureGroup:
    """Trials whose procedures are reported together, and the errors of all trajectories."""

    done: tuple[tuple[TrialRow, ProcedureOutcome], ...]
    lines: tuple[TrajectoryErrors, ...]

    @classmethod
    def of(
        cls, done: Sequence[tuple[TrialRow, ProcedureOutcome]], name: str = "", kind: str = ""
    ) -> ProcedureGroup:
        """Return the group of all procedures, or only those of one trainee or kind."""
        own = tuple(
            (trial, found)
            for trial, found in done
            if name in ("", trial.trainee) and kind in ("", found.analysis.kind)
        )
        lines = (line for _trial, found in own for line in found.analysis.trajectories)
        return cls(own, tuple(lines))

    def lengths(self, error: str, part: str = WHOLE) -> np.ndarray:
        """Return lengths of an error, or of one of its parts, one per trajectory, mm."""
        return np.array([getattr(getattr(line, error), part) for line in self.lines])

    def rms_text(self, error: str, part: str = WHOLE) -> str:
        return fixed(rms(self.lengths(error, part)), 2) if self.lines else "–"

    @property
    def target_errors(self) -> list[str]:
        """RMS of target point errors: whole, by registration, by hand, by robot and hand."""
        by_hand, by_robot = (self.aligned_by(robot=robot) for robot in (False, True))
        return [
            self.rms_text(TARGET),
            self.rms_text(TARGET, BY_REGISTRATION),
            by_hand.rms_text(TARGET, BY_HAND),
            by_robot.rms_text(TARGET, BY_HAND),
        ]

    @property
    def other_errors(self) -> list[str]:
        """RMS at the entry, RMS angle, deepest plunge, least distance from no-go structures."""
        angles = np.array([line.angular_deviation_deg for line in self.lines])
        plunge_mm = max((line.plunge_mm or 0.0 for line in self.lines), default=0.0)
        kept_mm = [distance for line in self.lines for distance in line.kept_mm.values()]
        kept = f"{fixed(min(kept_mm), 1)} ({self.hits})" if kept_mm else "–"
        entries = self.rms_text("entry_point_error")
        return [entries, fixed(rms(angles), 2), fixed(plunge_mm, 1), kept]

    @property
    def acceptable(self) -> int:
        """How many are acceptable."""
        return sum(found.score.acceptable for _trial, found in self.done)

    @property
    def mean_score(self) -> float:
        return float(np.mean([found.score.score for _trial, found in self.done]))

    @property
    def hits(self) -> int:
        """How often an instrument hit a no-go structure."""
        return sum(distance <= 0 for line in self.lines for distance in line.kept_mm.values())

    @property
    def trainees(self) -> dict[str, ProcedureGroup]:
        names = sorted({trial.trainee for trial, _found in self.done})
        return {name: ProcedureGroup.of(self.done, name=name) for name in names}

    @property
    def mean_times(self) -> list[str]:
        """Mean time of the whole trial, and of each of `PHASES`, s; alignments of a line."""
        analyses = [found.analysis for _trial, found in self.done]
        whole = [analysis.duration_s for analysis in analyses]
        phases = [
            [analysis.phase_times_s.get(phase, 0.0) for analysis in analyses] for phase in PHASES
        ]
        alignments = sum(analysis.alignments for analysis in analyses) / len(self.lines)
        times = [fixed(float(np.mean(each)), 0) for each in (whole, *phases)]
        return [*times, fixed(alignments, 2)]

    def aligned_by(self, *, robot: bool) -> ProcedureGroup:
        """Return the same with only the lines on which the robot, or a hand, aligned the guide."""
        return replace(self, lines=tuple(line for line in self.lines if line.self_aligned is robot))


def procedures(data: StudyData) -> Markup:
    """Return the section; "" without procedures that were scored."""
    done = [(trial, trial.procedure) for trial in data.trials if trial.procedure]
    if not done:
        return Markup()
    everything = ProcedureGroup.of(done)
    kinds = {kind: ProcedureGroup.of(done, kind=kind) for kind in KINDS}
    kinds = {kind: group for kind, group in kinds.items() if group.done}
    parts = {
        KINDS[kind]: (own.lengths(TARGET, BY_REGISTRATION), own.lengths(TARGET, BY_HAND))
        for kind, group in kinds.items()
        if (own := group.aligned_by(robot=False)).lines
    }
    return render(
        "procedures",
        trials=len(data.trials),
        everything=everything,
        kinds={KINDS[kind][0]: group for kind, group in kinds.items()},
        phases=list(PHASES.values()),
        over_trainees=_over_trainees(everything),
        chart=charts.split_chart(parts) if parts else None,
        limits=procedure_outcome,
    )


def _over_trainees(group: ProcedureGroup) -> dict[str, Any] | None:
    """Return the errors on lines aligned by hand, over the trainees; None for too few.

    Lines of a trainee are not independent.
    """
    by_hand = [own.aligned_by(robot=False) for own in group.trainees.values()]
    trainees = [own for own in by_hand if own.lines]
    if len(trainees) < LEAST_TRAINEES:
        return None
    whole, registration, hand = (
        np.array([rms(one.lengths(TARGET, part)) for one in trainees])
        for part in (WHOLE, BY_REGISTRATION, BY_HAND)
    )
    return {
        "count": len(trainees),
        "spread": mean(whole),
        "difference": mean(registration - hand),
    }
