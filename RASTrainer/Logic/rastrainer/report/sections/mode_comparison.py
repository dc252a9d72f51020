"""The comparison of the modes, task by task, as in the paper's Fig. 8."""

from __future__ import annotations

from rastrainer.report.charts.grouped_bars import Series, grouped_bars
from rastrainer.report.charts.svg import mode_color
from rastrainer.report.markup import figure, section
from rastrainer.report.outcomes import MAIN_OUTCOMES, Outcome, mode_title, task_title
from rastrainer.report.study_data import StudyData

SHOWN = ("completion_time_s", "rmse_mm", "ctps", "score")


def mode_comparison(data: StudyData) -> str:
    """Return one chart an outcome: modes side by side for every task."""
    charts = [
        _chart(data, outcome)
        for outcome in MAIN_OUTCOMES
        if outcome.name in SHOWN and any(outcome.name in trial.values for trial in data.trials)
    ]
    parts = [figure([chart], "") for chart in charts[:-1]]
    last = figure(
        charts[-1:], "Modes compared task by task, as in the paper's Fig. 8, with every trial."
    )
    return section("The modes, task by task", *parts, last)


def _chart(data: StudyData, outcome: Outcome) -> str:
    series = [
        Series(
            mode_title(mode),
            mode_color(mode, index),
            tuple(
                tuple(
                    trial.values[outcome.name]
                    for trial in data.of_mode(mode)
                    if trial.task == task and outcome.name in trial.values
                )
                for task in data.tasks
            ),
        )
        for index, mode in enumerate(data.modes)
    ]
    return grouped_bars(outcome.heading, [task_title(task) for task in data.tasks], series)
