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
from rastrainer_simulator.statistics.intervals import mean

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
    """Procedures that are reported together.

    Attributes:
        done: Trials that continued with one.
        lines: The errors of all their trajectories.
    """

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
        return fixed(_rms(self.lengths(error, part)), 2) if self.lines else "–"

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
    def angles_rms(self) -> float:
        """RMS of the angular deviations, degrees."""
        return _rms(np.array([line.angular_deviation_deg for line in self.lines]))

    @property
    def deepest_plunge_mm(self) -> float:
        return max((line.plunge_mm or 0.0 for line in self.lines), default=0.0)

    @property
    def acceptable(self) -> int:
        """How many are acceptable."""
        return sum(found.score.acceptable for _trial, found in self.done)

    @property
    def mean_score(self) -> float:
        return float(np.mean([found.score.score for _trial, found in self.done]))

    @property
    def kept_mm(self) -> list[float]:
        """Least distances of instruments from no-go structures; 0 or less is a hit."""
        return [distance for line in self.lines for distance in line.kept_mm.values()]

    @property
    def hits(self) -> int:
        return sum(distance <= 0 for distance in self.kept_mm)

    @property
    def trainees(self) -> dict[str, ProcedureGroup]:
        """The procedures of each trainee, sorted by the pseudonym."""
        names = sorted({trial.trainee for trial, _found in self.done})
        return {name: ProcedureGroup.of(self.done, name=name) for name in names}

    @property
    def mean_times_s(self) -> list[float]:
        """Mean time of the whole trial, and of each of `PHASES`."""
        analyses = [found.analysis for _trial, found in self.done]
        whole = [analysis.duration_s for analysis in analyses]
        phases = [
            [analysis.phase_times_s.get(phase, 0.0) for analysis in analyses] for phase in PHASES
        ]
        return [float(np.mean(times)) for times in (whole, *phases)]

    @property
    def alignments_a_line(self) -> float:
        return sum(found.analysis.alignments for _trial, found in self.done) / len(self.lines)

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
        np.array([_rms(one.lengths(TARGET, part)) for one in trainees])
        for part in (WHOLE, BY_REGISTRATION, BY_HAND)
    )
    return {
        "count": len(trainees),
        "spread": mean(whole),
        "difference": mean(registration - hand),
    }


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
