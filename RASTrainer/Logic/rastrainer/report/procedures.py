"""Procedures: how much of the target point error registration, hands and robot caused."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rastrainer.number_text import counted, fixed, percent
from rastrainer.report import page, svg
from rastrainer.statistics.intervals import Estimate, mean
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.trial.procedure_outcome import (
    ANGLE_LIMIT_DEG,
    ENTRY_LIMIT_MM,
    PLUNGE_LIMIT_MM,
    TARGET_LIMIT_MM,
)

KINDS = {
    "biopsy": ("Biopsy", "#1b6ca8"),
    "dbs": ("DBS", "#c2571a"),
    "seeg": ("SEEG", "#3f8f4f"),
}
"""Title and color of each kind."""
PUBLISHED = (
    ("phantoms: RONNA G3, ROSA, Leksell", "0.43, 0.53, 0.72", "10.3389/fnbot.2022.762317"),
    ("patients, DBS", "1.91", "10.1093/neuros/nyaa428"),
    ("patients, SEEG", "2.34", "10.1093/neuros/nyaa428"),
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
        lines: The errors of all their trajectories, as `TrajectoryErrors.to_json`.
    """

    trials: tuple[TrialRow, ...]
    lines: tuple[Mapping[str, Any], ...]

    @classmethod
    def of(cls, trials: Sequence[TrialRow]) -> _Group:
        """Return the group of trials that all have a procedure."""
        lines = [
            line for trial in trials if trial.procedure for line in trial.procedure.trajectories
        ]
        return cls(tuple(trials), tuple(lines))

    def lengths(self, error: str, part: str = "mm") -> np.ndarray:
        """Return lengths of an error, or of one of its parts, one per trajectory, mm."""
        return np.array([line[error][part] for line in self.lines])

    def rms(self, error: str, part: str = "mm") -> float:
        """Return the root mean square of an error, or of one of its parts, mm."""
        return _rms(self.lengths(error, part))

    @property
    def angle_deg(self) -> float:
        """Root mean square of the angular deviations."""
        return _rms(np.array([line["angularDeviationDeg"] for line in self.lines]))

    @property
    def scores(self) -> list[float]:
        return [trial.procedure.score.score for trial in self.trials if trial.procedure]

    @property
    def acceptable(self) -> int:
        """How many are acceptable."""
        return sum(trial.procedure.score.acceptable for trial in self.trials if trial.procedure)

    @property
    def hits(self) -> int:
        """How many times an instrument hit a no-go structure."""
        return sum(distance <= 0 for distance in self._kept_mm)

    @property
    def least_kept_mm(self) -> float | None:
        """Least distance from a no-go structure; None if there was no such structure."""
        return min(self._kept_mm, default=None)

    @property
    def _kept_mm(self) -> list[float]:
        return [distance for line in self.lines for distance in line["keptMm"].values()]

    @property
    def plunge_mm(self) -> float:
        """The deepest that a drill was past an inner table."""
        return max((line["plungeMm"] or 0.0 for line in self.lines), default=0.0)

    @property
    def trainees(self) -> tuple[str, ...]:
        """Who carried them out, sorted."""
        return tuple(sorted({trial.trainee for trial in self.trials}))

    def aligned_by(self, *, robot: bool) -> _Group:
        """Return the same with only the lines on which the robot, or a hand, aligned the guide."""
        return replace(
            self, lines=tuple(line for line in self.lines if line["selfAligned"] is robot)
        )

    @property
    def by_trainee(self) -> list[_Group]:
        """The procedures of each trainee, in the order of `trainees`."""
        return [
            _Group.of([trial for trial in self.trials if trial.trainee == name])
            for name in self.trainees
        ]


def procedures(data: StudyData) -> str:
    """Return the section; "" without procedures that were scored."""
    done = [trial for trial in data.trials if trial.procedure is not None]
    if not done:
        return ""
    everything = _Group.of(done)
    kinds = {
        kind: _Group.of([t for t in done if t.procedure is not None and t.procedure.kind == kind])
        for kind in KINDS
        if any(t.procedure is not None and t.procedure.kind == kind for t in done)
    }
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
        page.paragraph(_explanation(), "small"),
        page.figure([split_chart(charted)], caption) if charted else "",
        page.table([list(TIME_HEADER)], [_time_row(KINDS[kind][0], kinds[kind]) for kind in kinds]),
        page.heading("Trainees"),
        page.table([list(TRAINEE_HEADER)], _trainee_rows(everything)),
        page.heading("Published figures, for orientation"),
        page.table(
            [["what", "target point error (mm)", "source"]],
            [[what, errors, f"doi:{doi}"] for what, errors, doi in PUBLISHED],
        ),
        page.paragraph(
            "They are no pass marks: patients, images and definitions differ between studies, and "
            "a simulator has no brain shift and no resistance of tissue.",
            "small",
        ),
    )


def _sentences(group: _Group, trials: int) -> list[str]:
    registration = group.rms("targetPointError", "byRegistrationMm")
    return [
        f"{len(group.trials)} of {counted(trials, 'trial')} continued with a procedure: "
        f"{counted(len(group.lines), 'line')} in all, by "
        f"{counted(len(group.trainees), 'trainee')}. The target point error was "
        f"{fixed(group.rms('targetPointError'), 2)} mm (RMS over all lines); the part that the "
        f"registration caused was {fixed(registration, 2)} mm.",
        *_after_registration(group),
        *_over_trainees(group),
        f"{group.acceptable} of {len(group.trials)} procedures were acceptable "
        f"({percent(group.acceptable / len(group.trials))}); "
        f"{_hits(group.hits)}.",
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
        f"{_lines(group, robot=robot)} aligned {words} {_rms_text(group, robot=robot)} {rest}"
        for robot, words, rest in said
        if group.aligned_by(robot=robot).lines
    ]


def _rms_text(group: _Group, *, robot: bool) -> str:
    """Return what the registration did not cause of the target point error; "–" without lines."""
    own = group.aligned_by(robot=robot)
    return fixed(own.rms("targetPointError", "byHandMm"), 2) if own.lines else "–"


def _lines(group: _Group, *, robot: bool) -> str:
    count = len(group.aligned_by(robot=robot).lines)
    return f"{counted(count, 'line')} {'was' if count == 1 else 'were'}"


def _lines_cell(group: _Group) -> str:
    by_robot = len(group.aligned_by(robot=True).lines)
    return f"{len(group.lines)} ({by_robot})" if by_robot else str(len(group.lines))


def _hits(count: int) -> str:
    if count == 0:
        return "no instrument hit a no-go structure"
    return f"{counted(count, 'time')} an instrument hit a no-go structure"


def _over_trainees(group: _Group) -> list[str]:
    """Return the errors on lines aligned by hand, over the trainees; nothing for too few.

    Lines of a trainee are not independent.
    """
    trainees = [one for own in group.by_trainee if (one := own.aligned_by(robot=False)).lines]
    if len(trainees) < LEAST_TRAINEES:
        return []
    own = [
        [one.rms("targetPointError", part) for one in trainees]
        for part in ("mm", "byRegistrationMm", "byHandMm")
    ]
    whole, registration, hand = map(np.array, own)
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
    return [
        title,
        str(len(group.trials)),
        _lines_cell(group),
        str(len(group.trainees)),
        fixed(group.rms("targetPointError"), 2),
        fixed(group.rms("targetPointError", "byRegistrationMm"), 2),
        *(_rms_text(group, robot=robot) for robot in (False, True)),
        fixed(group.rms("entryPointError"), 2),
        fixed(group.angle_deg, 2),
        fixed(group.plunge_mm, 1),
        "–" if group.least_kept_mm is None else f"{fixed(group.least_kept_mm, 1)} ({group.hits})",
        f"{group.acceptable} of {len(group.trials)}",
    ]


def _time_row(title: str, group: _Group) -> list[str]:
    analyses = [trial.procedure.analysis for trial in group.trials if trial.procedure]
    means = [
        float(np.mean([analysis["phaseTimesS"].get(phase, 0.0) for analysis in analyses]))
        for phase in PHASES
    ]
    alignments = sum(analysis["alignments"] for analysis in analyses) / len(group.lines)
    return [
        title,
        str(len(group.trials)),
        fixed(float(np.mean([analysis["durationS"] for analysis in analyses])), 0),
        *(fixed(value, 0) for value in means),
        fixed(alignments, 2),
    ]


def _trainee_rows(everything: _Group) -> list[list[str]]:
    return [
        [
            name,
            str(len(group.trials)),
            _lines_cell(group),
            fixed(group.rms("targetPointError"), 2),
            fixed(group.rms("targetPointError", "byRegistrationMm"), 2),
            *(_rms_text(group, robot=robot) for robot in (False, True)),
            fixed(float(np.mean(group.scores)), 1),
        ]
        for name, group in zip(everything.trainees, everything.by_trainee, strict=True)
    ]


def _explanation() -> str:
    return (
        "n counts procedures. RMS are over all lines, which are not independent: those of one "
        "procedure share a registration. The trainee saw the plan where their own registration put "
        "it; the error of each target is the sum of two vectors, from the plan to where it was "
        "shown, and from there to the instrument's tip: the second is the hand's, or the robot's "
        "where it brought the guide onto the line. Their lengths do not add up: the two parts "
        "may cancel out. A procedure is acceptable where each instrument meets the skull, no entry "
        f"is off by more than {ENTRY_LIMIT_MM:g} mm, no target by more than {TARGET_LIMIT_MM:g} mm "
        f"and no line by more than {ANGLE_LIMIT_DEG:g}°, no drill goes more than "
        f"{PLUNGE_LIMIT_MM:g} mm past the inner table, and nothing is hit. The same angular "
        "deviation misses a deeper target by more. Geometry is rigid, and depths of drilling are "
        "for training."
    )


def split_chart(kinds: Mapping[str, _Group]) -> str:
    """Return the chart of both parts of the target point errors; both axes start at 0."""
    points = {
        kind: (
            group.lengths("targetPointError", "byRegistrationMm"),
            group.lengths("targetPointError", "byHandMm"),
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


def _rms(values: np.ndarray) -> float:
    return math.sqrt(float(np.mean(np.square(values))))
