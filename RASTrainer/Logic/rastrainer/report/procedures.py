"""Procedures: how much of the target point error registration, hands and robot caused."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rastrainer.number_text import counted, fixed, percent
from rastrainer.procedure.errors import TrajectoryErrors
from rastrainer.report import page, svg
from rastrainer.statistics.intervals import Estimate, mean
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.trial.procedure_outcome import (
    ANGLE_LIMIT_DEG,
    ENTRY_LIMIT_MM,
    PLUNGE_LIMIT_MM,
    TARGET_LIMIT_MM,
    ProcedureScore,
)

KINDS = {
    "biopsy": ("Biopsy", "#1b6ca8"),
    "dbs": ("DBS", "#c2571a"),
    "seeg": ("SEEG", "#3f8f4f"),
}
"""Title and color of each kind."""
PUBLISHED = (
    ("phantoms: RONNA G3, ROSA, Leksell", "0.43, 0.53, 0.72", "doi:10.3389/fnbot.2022.762317"),
    ("patients, DBS", "1.91", "doi:10.1093/neuros/nyaa428"),
    ("patients, SEEG", "2.34", "doi:10.1093/neuros/nyaa428"),
)
HEADER = (
    *("Kind", "n", "lines (by robot)", "trainees", "target, RMS (mm)", "by registration (mm)"),
    *("by hand (mm)", "by robot and hand (mm)", "entry, RMS (mm)", "angle, RMS (°)"),
    "deepest plunge (mm)",
    *("least distance kept (mm) (hits)", "acceptable"),
)
PHASES = {
    "running": "touching",
    "verifying": "verifying",
    "aligning": "aligning",
    "drilling": "drilling",
    "inserting": "inserting",
}
"""Title of each phase."""
TIME_HEADER = (
    *("Procedure, mean times (s)", "n", "whole", *PHASES.values()),
    "alignments a line",
)
TRAINEE_HEADER = (
    *("trainee", "n", "lines (by robot)", "target, RMS (mm)", "by registration (mm)"),
    *("by hand (mm)", "by robot and hand (mm)", "score, mean"),
)

LEAST_TRAINEES = 3
"""Fewer say nothing about others."""


@dataclass(frozen=True)
class _Group:
    """Procedures that are reported together.

    Attributes:
        trials: Those that continued with a procedure.
        lines: The errors of all their trajectories.
    """

    trials: tuple[TrialRow, ...]
    lines: tuple[TrajectoryErrors, ...]

    @classmethod
    def of(cls, trials: Sequence[TrialRow], name: str = "", kind: str = "") -> _Group:
        """Return the group of the procedures among trials: all, a trainee's, or of one kind."""
        done = [
            (trial, trial.procedure)
            for trial in trials
            if trial.procedure
            and name in ("", trial.trainee)
            and kind in ("", trial.procedure.analysis.kind)
        ]
        lines = tuple(line for _trial, found in done for line in found.analysis.trajectories)
        return cls(tuple(trial for trial, _found in done), lines)

    def lengths(self, error: str, part: str = "mm") -> np.ndarray:
        """Return lengths of an error, or of one of its parts, one per trajectory, mm."""
        return np.array([getattr(getattr(line, error), part) for line in self.lines])

    def rms_text(self, error: str, part: str = "mm") -> str:
        return _rms_text(self.lengths(error, part)) if self.lines else "–"

    @property
    def scores(self) -> list[ProcedureScore]:
        return [trial.procedure.score for trial in self.trials if trial.procedure]

    @property
    def acceptable(self) -> int:
        """How many are acceptable."""
        return sum(score.acceptable for score in self.scores)

    @property
    def kept_mm(self) -> list[float]:
        """Least distances of instruments from no-go structures; 0 or less is a hit."""
        return [distance for line in self.lines for distance in line.kept_mm.values()]

    @property
    def hits(self) -> int:
        return sum(distance <= 0 for distance in self.kept_mm)

    @property
    def trainees(self) -> dict[str, _Group]:
        """The procedures of each trainee, sorted by the pseudonym."""
        names = sorted({trial.trainee for trial in self.trials})
        return {name: _Group.of(self.trials, name=name) for name in names}

    def aligned_by(self, *, robot: bool) -> _Group:
        """Return the same with only the lines on which the robot, or a hand, aligned the guide."""
        return replace(self, lines=tuple(line for line in self.lines if line.self_aligned is robot))


def procedures(data: StudyData) -> str:
    """Return the section; "" without procedures that were scored."""
    everything = _Group.of(data.trials)
    if not everything.trials:
        return ""
    kinds = {kind: group for kind in KINDS if (group := _Group.of(data.trials, kind=kind)).trials}
    rows = [_row(KINDS[kind][0], group) for kind, group in kinds.items()]
    if len(rows) > 1:
        rows.append(_row("all", everything))
    caption = (
        "Every trajectory whose guide was aligned by hand: how far the registration alone put its "
        "target, and how far the hand ended from there. Below the line, the hand caused the larger "
        "part."
    )
    by_hand = {kind: group.aligned_by(robot=False) for kind, group in kinds.items()}
    charted = {kind: group for kind, group in by_hand.items() if group.lines}
    return page.section(
        "Procedures: from the registration to the target",
        page.bullets(_sentences(everything, len(data.trials))),
        page.table([list(HEADER)], rows, "wide"),
        page.note(EXPLANATION),
        page.figure([split_chart(charted)], caption) if charted else "",
        page.table([list(TIME_HEADER)], [_time_row(KINDS[kind][0], kinds[kind]) for kind in kinds]),
        page.heading("Trainees"),
        page.table([list(TRAINEE_HEADER)], _trainee_rows(everything)),
        page.heading("Published figures, for orientation"),
        page.table([["what", "target point error (mm)", "source"]], PUBLISHED),
        page.note(
            "They are no pass marks: patients, images and definitions differ between studies, and "
            "a simulator has no brain shift and no resistance of tissue."
        ),
    )


def _sentences(group: _Group, trials: int) -> list[str]:
    hits = f"{counted(group.hits, 'time')} an" if group.hits else "no"
    return [
        f"{len(group.trials)} of {counted(trials, 'trial')} continued with a procedure: "
        f"{counted(len(group.lines), 'line')} in all, by "
        f"{counted(len(group.trainees), 'trainee')}. The target point error was "
        f"{group.rms_text('target_point_error')} mm (RMS over all lines); the part that the "
        f"registration caused was {group.rms_text('target_point_error', 'by_registration_mm')} mm.",
        *_after_registration(group),
        *_over_trainees(group),
        f"{group.acceptable} of {len(group.trials)} procedures were acceptable "
        f"({percent(group.acceptable / len(group.trials))}); "
        f"{hits} instrument hit a no-go structure.",
    ]


def _after_registration(group: _Group) -> list[str]:
    """Return what hands and robot caused, on the lines that each of them aligned."""
    said = (
        (False, "by hand: there the hands caused", "mm."),
        (
            True,
            "by the robot: there robot and hands caused",
            "mm, of which only the depth is by hand. Comparisons of hands and registration leave "
            "these lines out.",
        ),
    )
    return [
        f"{counted(len(own.lines), 'line')} {'was' if len(own.lines) == 1 else 'were'} aligned "
        f"{words} {own.rms_text('target_point_error', 'by_hand_mm')} {rest}"
        for robot, words, rest in said
        if (own := group.aligned_by(robot=robot)).lines
    ]


def _lines_cell(group: _Group) -> str:
    by_robot = len(group.aligned_by(robot=True).lines)
    return f"{len(group.lines)} ({by_robot})" if by_robot else str(len(group.lines))


def _over_trainees(group: _Group) -> list[str]:
    """Return the errors on lines aligned by hand, over the trainees; nothing for too few.

    Lines of a trainee are not independent.
    """
    by_hand = [own.aligned_by(robot=False) for own in group.trainees.values()]
    trainees = [own for own in by_hand if own.lines]
    if len(trainees) < LEAST_TRAINEES:
        return []
    whole, registration, hand = (
        np.array([_rms(one.lengths("target_point_error", part)) for one in trainees])
        for part in ("mm", "by_registration_mm", "by_hand_mm")
    )
    spread, difference = mean(whole), mean(registration - hand)
    verdict = "it cannot be said which of both caused more"
    if difference.interval[0] > 0:
        verdict = "the registration caused more than the hands"
    elif difference.interval[1] < 0:
        verdict = "the hands caused more than the registration"
    return [
        f"On lines aligned by hand, each trainee's own RMS was {_on_average(spread)}.",
        f"Over {len(trainees)} trainees, {verdict}: registration minus hands, as RMS of each "
        f"trainee, was {_on_average(difference)}.",
    ]


def _on_average(found: Estimate) -> str:
    low, high = found.interval
    return f"{fixed(found.value, 2)} mm on average [95 %: {fixed(low, 2)}, {fixed(high, 2)}]"


def _row(title: str, group: _Group) -> list[str]:
    angles = np.array([line.angular_deviation_deg for line in group.lines])
    plunge_mm = max((line.plunge_mm or 0.0 for line in group.lines), default=0.0)
    kept = f"{fixed(min(group.kept_mm), 1)} ({group.hits})" if group.kept_mm else "–"
    return [
        title,
        str(len(group.trials)),
        _lines_cell(group),
        str(len(group.trainees)),
        *_target_errors(group),
        group.rms_text("entry_point_error"),
        _rms_text(angles),
        fixed(plunge_mm, 1),
        kept,
        f"{group.acceptable} of {len(group.trials)}",
    ]


def _target_errors(group: _Group) -> list[str]:
    """Return the RMS of target point errors: whole, by registration, by hand, by robot and hand."""
    own = (group.aligned_by(robot=robot) for robot in (False, True))
    return [
        *(group.rms_text("target_point_error", part) for part in ("mm", "by_registration_mm")),
        *(each.rms_text("target_point_error", "by_hand_mm") for each in own),
    ]


def _time_row(title: str, group: _Group) -> list[str]:
    analyses = [trial.procedure.analysis for trial in group.trials if trial.procedure]
    means = [
        float(np.mean([analysis.phase_times_s.get(phase, 0.0) for analysis in analyses]))
        for phase in PHASES
    ]
    alignments = sum(analysis.alignments for analysis in analyses) / len(group.lines)
    return [
        title,
        str(len(group.trials)),
        fixed(float(np.mean([analysis.duration_s for analysis in analyses])), 0),
        *(fixed(value, 0) for value in means),
        fixed(alignments, 2),
    ]


def _trainee_rows(everything: _Group) -> list[list[str]]:
    return [
        [
            *(name, str(len(group.trials)), _lines_cell(group), *_target_errors(group)),
            fixed(float(np.mean([score.score for score in group.scores])), 1),
        ]
        for name, group in everything.trainees.items()
    ]


EXPLANATION = (
    "n counts procedures. RMS are over all lines, which are not independent: those of one "
    "procedure share a registration. The trainee saw the plan where their own registration put it; "
    "the error of each target is the sum of two vectors, from the plan to where it was shown, and "
    "from there to the instrument's tip: the second is the hand's, or the robot's where it brought "
    "the guide onto the line. Their lengths do not add up: the two parts may cancel out. A "
    "procedure is acceptable where each instrument meets the skull, no entry is off by more than "
    f"{ENTRY_LIMIT_MM:g} mm, no target by more than {TARGET_LIMIT_MM:g} mm and no line by more "
    f"than {ANGLE_LIMIT_DEG:g}°, no drill goes more than {PLUNGE_LIMIT_MM:g} mm past the inner "
    "table, and nothing is hit. The same angular deviation misses a deeper target by more. "
    "Geometry is rigid, and depths of drilling are for training."
)


def split_chart(kinds: Mapping[str, _Group]) -> str:
    """Return the chart of both parts of the target point errors; both axes start at 0."""
    points = {
        kind: (
            group.lengths("target_point_error", "by_registration_mm"),
            group.lengths("target_point_error", "by_hand_mm"),
        )
        for kind, group in kinds.items()
    }
    largest = max(float(values.max()) for both in points.values() for values in both)
    sheet, along, up = svg.scatter_sheet(
        "What caused the target point error (mm)",
        "by the hand (mm)",
        "by the registration (mm)",
        largest,
        largest,
    )
    count = sum(len(both[0]) for both in points.values())
    radius = 3.4 if count <= 150 else 2.2
    for kind, (by_registration, by_hand) in points.items():
        for x, y in zip(by_hand, by_registration, strict=True):
            sheet.dot(along.at(float(x)), up.at(float(y)), radius, KINDS[kind][1], 0.75)
    x = float(svg.SCATTER_LEFT)
    for kind in points:
        name, color = KINDS[kind]
        sheet.dot(x + 5, 34, 3.6, color, 0.85)
        sheet.text(x + 14, 38, name, 11)
        x += 36 + 6 * len(name)
    sheet.line(x, 34, x + 22, 34, svg.INK, 1.3, "5 4")
    sheet.text(x + 28, 38, "both parts equal", 11)
    return sheet.svg()


def _rms_text(values: np.ndarray) -> str:
    return fixed(_rms(values), 2)


def _rms(values: np.ndarray) -> float:
    return math.sqrt(float(np.mean(np.square(values))))
