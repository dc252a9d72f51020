"""How the trials are distributed."""

from __future__ import annotations

from rastrainer.report.charts.distributions import distributions
from rastrainer.report.charts.svg import mode_color
from rastrainer.report.markup import figure, section
from rastrainer.report.outcomes import MAIN_OUTCOMES, mode_title
from rastrainer.report.study_data import StudyData


def spread(data: StudyData) -> str:
    """Return a chart an outcome, each with a lane a mode."""
    charts = []
    for outcome in MAIN_OUTCOMES:
        lanes = []
        for index, mode in enumerate(data.modes):
            values = [
                t.values[outcome.name] for t in data.of_mode(mode) if outcome.name in t.values
            ]
            if values:
                lanes.append((mode_title(mode), mode_color(mode, index), values))
        if lanes:
            charts.append(distributions(outcome.heading, lanes))
    caption = "All trials; below the dots the middle half, the median, and the whole range."
    return section("Distributions", figure(charts, caption))
