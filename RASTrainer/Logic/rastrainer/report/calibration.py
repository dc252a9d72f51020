"""Calibration of the expected target errors, which only a simulator can provide."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer.number_text import fixed
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.report import page, svg
from rastrainer.statistics.intervals import Proportion
from rastrainer.study.outcomes import mode_title, short_mode_title
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.study.tre_calibration import CalibrationPoint, TreCalibration, share_text

HEADER = [
    *("mode", "n", "true, RMS (mm)", "expected, RMS (mm)"),
    *("inside [95 %]", "larger", "smaller"),
]


NOTE = (
    "True errors that lie above their intervals mostly come from touches that share an offset: "
    "hovering, aiming beside, a view that misleads. The share's own interval is Wilson's (1927); "
    "it takes the trials as independent, which those of one trainee are not."
)


def calibration(data: StudyData) -> str:
    """Return the section; "" if no target errors are known."""
    points = [point for point in map(_point, data.trials) if point is not None]
    known = sum({"expected_tre_mm", "tre_low_mm"} <= set(trial.values) for trial in data.trials)
    found = TreCalibration.of(points, known - len(points), len(data.trials) - known)
    if not found.points and not found.without_truth:
        return ""
    parts = [page.bullets(found.sentences())]
    if found.points:
        colors = {
            mode: (short_mode_title(mode), svg.mode_color(mode, index))
            for index, mode in enumerate(data.modes)
            if found.of_mode(mode).points
        }
        caption = (
            "Every trial with both errors at the scenario's target. Bars: the interval in which "
            "the true error was to lie; rimmed: it does not. The axes have different scales."
        )
        parted = {mode_title(mode): found.of_mode(mode) for mode in colors}
        if len(parted) > 1:
            parted["all"] = found
        rows = [
            _row(title, part, inside)
            for title, part in parted.items()
            if (inside := part.inside) is not None
        ]
        parts += [
            page.figure([calibration_chart(found, colors)], caption),
            page.table([HEADER], rows),
        ]
    parts.append(page.paragraph(f"{INTERVAL_NOTE} {NOTE}", "small"))
    return page.section("Expected and true target error", *parts)


def _point(trial: TrialRow) -> CalibrationPoint | None:
    values = trial.values
    if not {"expected_tre_mm", "tre_low_mm", "tre_high_mm", "true_tre_mm"} <= set(values):
        return None
    interval = values["tre_low_mm"], values["tre_high_mm"]
    errors = values["expected_tre_mm"], interval, values["true_tre_mm"]
    return CalibrationPoint(trial.trainee, trial.mode, trial.task, *errors)


def _row(title: str, found: TreCalibration, inside: Proportion) -> list[str]:
    count = len(found.points)
    return [
        title,
        str(count),
        fixed(found.true_rms_mm, 2),
        fixed(found.expected_rms_mm, 2),
        share_text(inside),
        str(found.above),
        str(count - inside.count - found.above),
    ]


OFF = "#b3261e"
"""Outline of points outside their interval."""


def calibration_chart(calibration: TreCalibration, colors: Mapping[str, tuple[str, str]]) -> str:
    """Return the chart; both axes start at 0 and have different scales."""
    points = calibration.points
    sheet, along, up = svg.scatter_sheet(
        "True against expected target error (mm)",
        "expected TRE (mm)",
        "true TRE (mm)",
        max(point.expected_mm for point in points),
        max(max(point.true_mm, point.interval_mm[1]) for point in points),
    )
    # Bars of many trials overlap.
    opacity = max(0.05, min(0.55, 14 / len(points)))
    for point in points:
        x, color = along.at(point.expected_mm), colors[point.mode][1]
        low, high = (up.at(end) for end in point.interval_mm)
        sheet.polyline([(x, low), (x, high)], color, 1.6, opacity)
        for end in (low, high):
            sheet.polyline([(x - 2.5, end), (x + 2.5, end)], color, 1.2, opacity)
    radius = 3.6 if len(points) <= 120 else 2.4
    for point in points:
        x, y = along.at(point.expected_mm), up.at(point.true_mm)
        if not point.is_inside:
            sheet.dot(x, y, radius + 2.4, OFF)
        words = (
            f"{point.trainee}, {point.task}: true {fixed(point.true_mm, 2)} mm, expected "
            f"{fixed(point.expected_mm, 2)} mm"
        )
        sheet.dot(x, y, radius, colors[point.mode][1], 0.85, words)
    _legend(sheet, colors)
    return sheet.svg()


def _legend(sheet: svg.Sheet, colors: Mapping[str, tuple[str, str]]) -> None:
    x, y = float(svg.SCATTER_LEFT), 38.0
    for title, color in colors.values():
        sheet.dot(x + 5, y - 4, 3.6, color, 0.85)
        x = _words(sheet, x + 14, y, title)
    sheet.dot(x + 5, y - 4, 6, OFF)
    sheet.dot(x + 5, y - 4, 3.6, svg.GRID)
    x = _words(sheet, x + 16, y, "outside of its interval")
    sheet.line(x + 5, y - 11, x + 5, y + 3, svg.FAINT, 1.6)
    x = _words(sheet, x + 14, y, "95 % interval")
    sheet.line(x, y - 4, x + 22, y - 4, svg.INK, 1.3, "5 4")
    _words(sheet, x + 28, y, "true = expected")


def _words(sheet: svg.Sheet, x: float, y: float, text: str) -> float:
    """Draw a name and return the position of the next."""
    sheet.text(x, y, text, 11)
    return x + 22 + 5.1 * len(text)
