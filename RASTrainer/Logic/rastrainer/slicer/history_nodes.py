"""A trainee's history as a table, and its learning curves as a plot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rastrainer.registration import RIGID
from rastrainer.slicer.scene import ROLE_ATTRIBUTE, Role, findNode, findOrAddNode
from rastrainer.slicer.tables import Column, showTable
from rastrainer.study import StoredTrial

BEST_SCORE = 100.0
FEWEST_SHOWN = 5.0
"""Trials for which there is room in the plot from the first one on."""
TRIAL_COLUMN = "trial"
SCORE_COLUMN = "score"
_SERIES = {
    # Column, its title in the plot, color.
    SCORE_COLUMN: ("Score (0 to 100)", (0.15, 0.4, 0.75)),
    "completion time (s)": ("Completion time (s)", (0.85, 0.45, 0.1)),
}


def showHistory(scene: Any, pseudonym: str, trials: Sequence[StoredTrial]) -> Any:
    """Show the trials of a trainee in a `vtkMRMLTableNode`, one a row, and return it."""
    records = [trial.record for trial in trials]
    rigid = [trial.registrations.get(RIGID) for trial in trials]
    return showTable(
        scene,
        Role.HISTORY,
        f"History of {pseudonym}",
        [
            Column(TRIAL_COLUMN, range(1, len(trials) + 1)),
            Column("started (UTC)", [record.started_utc[:19] for record in records], isText=True),
            Column("task", [record.task for record in records], isText=True),
            Column("mode", [record.mode for record in records], isText=True),
            Column("completion time (s)", [record.completion_time_s for record in records]),
            Column("FRE (mm)", [fit and fit.fre_mm for fit in rigid]),
            Column("expected TRE (mm)", [fit and fit.expected_tre_mm for fit in rigid]),
            Column("true TRE (mm)", [trial.true_tre_mm for trial in trials]),
            Column(SCORE_COLUMN, [trial.score and trial.score.score for trial in trials]),
            Column(
                "score version",
                [trial.score.version if trial.score else "" for trial in trials],
                isText=True,
            ),
        ],
    )


def showLearningCurve(scene: Any, pseudonym: str, trials: Sequence[StoredTrial]) -> Any:
    """Plot score and time over the trials in a `vtkMRMLPlotChartNode` and return it."""
    table = showHistory(scene, pseudonym, trials)
    chart = findOrAddNode(
        scene, "vtkMRMLPlotChartNode", Role.LEARNING_CURVE, f"Learning curve of {pseudonym}"
    )
    chart.SetName(f"Learning curve of {pseudonym}")
    chart.RemoveAllPlotSeriesNodeIDs()
    for column, (title, color) in _SERIES.items():
        series = plotSeries(scene, table, Role.LEARNING_CURVE, TRIAL_COLUMN, column, title, color)
        chart.AddAndObservePlotSeriesNodeID(series.GetID())
    chart.SetTitle(_titleOf(pseudonym, trials))
    chart.SetXAxisTitle("Trial")
    chart.SetYAxisTitle("Score, and completion time in s")
    chart.SetXAxisRangeAuto(False)
    chart.SetXAxisRange(0.0, max(FEWEST_SHOWN, len(trials) + 1.0))
    chart.SetYAxisRangeAuto(False)
    times = (trial.record.completion_time_s for trial in trials)
    chart.SetYAxisRange(0.0, 1.05 * max((BEST_SCORE, *times)))
    return chart


def _titleOf(pseudonym: str, trials: Sequence[StoredTrial]) -> str:
    versions = sorted({trial.score.version for trial in trials if trial.score})
    title = f"Learning curve of {pseudonym}"
    if len(versions) < 2:
        return title
    return f"{title} (scores of versions {' and '.join(versions)} do not compare)"


def plotSeries(
    scene: Any,
    table: Any,
    role: str,
    across: str,
    column: str,
    title: str,
    color: tuple[float, float, float],
) -> Any:
    """Return the `vtkMRMLPlotSeriesNode` of a role that draws a column over another one.

    Args:
        scene: the scene.
        table: a `vtkMRMLTableNode` with both columns.
        role: of the chart.
        across: the column of x.
        column: the column of y.
        title: in the plot's legend.
        color: RGB from 0 to 1.
    """
    seriesRole = f"{role} {column}"
    node = findNode(scene, "vtkMRMLPlotSeriesNode", seriesRole)
    if node is None:
        node = scene.AddNewNodeByClass("vtkMRMLPlotSeriesNode", title)
        node.SetAttribute(ROLE_ATTRIBUTE, seriesRole)
    node.SetAndObserveTableNodeID(table.GetID())
    node.SetPlotType(node.PlotTypeScatter)
    node.SetXColumnName(across)
    node.SetYColumnName(column)
    node.SetColor(color)
    node.SetLineStyle(node.LineStyleSolid)
    node.SetMarkerStyle(node.MarkerStyleCircle)
    return node
