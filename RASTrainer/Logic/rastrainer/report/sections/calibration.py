"""Whether the target errors that were expected came true, which only a simulator can tell."""

from __future__ import annotations

from rastrainer.number_text import fixed
from rastrainer.report.charts.calibration import calibration_chart
from rastrainer.report.charts.svg import mode_color
from rastrainer.report.markup import bullets, figure, paragraph, section, table
from rastrainer.report.outcomes import mode_title
from rastrainer.report.study_data import StudyData, TrialRow
from rastrainer.target_error import INTERVAL_NOTE
from rastrainer.tre_calibration import CalibrationPoint, TreCalibration, share_text

HEADER = [
    *("mode", "n", "true, RMS (mm)", "expected, RMS (mm)"),
    *("inside [95 %]", "larger", "smaller"),
]


def calibration(data: StudyData) -> str:
    """Return the section; "" where nothing is known of target errors.

    Raises:
        InputError: scipy is missing.
    """
    found = _calibration(data)
    if not found.points and not found.without_truth:
        return ""
    parts = [bullets(found.sentences())]
    if found.points:
        colors = {
            mode: (mode_title(mode).split(" ")[0], mode_color(mode, index))
            for index, mode in enumerate(data.modes)
            if found.of_mode(mode).points
        }
        caption = (
            "Every trial with both errors at the scenario's target. Bars: the interval in which "
            "the true error was to lie; rimmed: it does not. The axes have different scales."
        )
        rows = [_row(mode_title(mode), found.of_mode(mode)) for mode in colors]
        if len(rows) > 1:
            rows.append(_row("all", found))
        parts += [figure([calibration_chart(found, colors)], caption), table([HEADER], rows)]
    parts.append(paragraph(f"{INTERVAL_NOTE} {_words()}", "small"))
    return section("Expected and true target error", *parts)


def _calibration(data: StudyData) -> TreCalibration:
    points = [point for point in map(_point, data.trials) if point is not None]
    known = [{"expected_tre_mm", "tre_low_mm"} <= set(trial.values) for trial in data.trials]
    without_truth = sum(known) - len(points)
    return TreCalibration.of(points, without_truth, len(known) - sum(known))


def _point(trial: TrialRow) -> CalibrationPoint | None:
    values = trial.values
    if not {"expected_tre_mm", "tre_low_mm", "tre_high_mm", "true_tre_mm"} <= set(values):
        return None
    return CalibrationPoint(
        trial.trainee,
        trial.mode,
        trial.task,
        values["expected_tre_mm"],
        (values["tre_low_mm"], values["tre_high_mm"]),
        values["true_tre_mm"],
        values.get("tre_common_bias_sd_mm", 0.0) > 0.0,
    )


def _row(title: str, found: TreCalibration) -> list[str]:
    inside, count = found.inside, len(found.points)
    return [
        title,
        str(count),
        fixed(found.true_rms_mm, 2),
        fixed(found.expected_rms_mm, 2),
        share_text(inside),
        str(found.above),
        str(count - inside.count - found.above),
    ]


def _words() -> str:
    return (
        "True errors that lie above their intervals mostly come from touches that share an offset: "
        "hovering, aiming beside, a view that misleads. The share's own interval is Wilson's "
        "(1927); it takes the trials as independent, which those of one trainee are not."
    )
