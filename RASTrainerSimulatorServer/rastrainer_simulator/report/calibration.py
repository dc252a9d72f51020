"""Calibration of the expected target errors, which only a simulator can provide."""

from __future__ import annotations

from markupsafe import Markup

from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.study.outcomes import mode_title, short_mode_title
from rastrainer.study.study_data import StudyData
from rastrainer.study.tre_calibration import calibration_of
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.page import render


def calibration(data: StudyData) -> Markup:
    """Return the section; "" if no target errors are known."""
    found = calibration_of(data.trials)
    if not found.points and not found.without_truth:
        return Markup()
    colors = {
        mode: (short_mode_title(mode), charts.mode_color(mode, index))
        for index, mode in enumerate(data.modes)
        if found.of_mode(mode).points
    }
    parted = {mode_title(mode): found.of_mode(mode) for mode in colors}
    if len(parted) > 1:
        parted["all"] = found
    chart = charts.calibration_chart(found.points, colors) if found.points else None
    return render("calibration", found=found, parted=parted, chart=chart, note=INTERVAL_NOTE)
