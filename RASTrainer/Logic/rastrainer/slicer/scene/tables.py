"""Numbers and texts as table nodes, with the unit in each column's name, and plots of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import vtk

from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, Role, changedOnce, findNode, findOrAddNode
from rastrainer.slicer.translation import _
from rastrainer.study.database.values import StoredTrial

if TYPE_CHECKING:
    from rastrainer.study.tre_calibration import TreCalibration


@dataclass(frozen=True)
class Column:
    """One column of a table: texts, or numbers where None is unknown."""

    name: str
    values: Sequence[str] | Sequence[float | None] | np.ndarray
    isText: bool = False


def showTable(scene: Any, role: str, name: str, columns: Sequence[Column]) -> Any:
    """Put columns into the `vtkMRMLTableNode` of a role and return it."""
    node = findOrAddNode(scene, "vtkMRMLTableNode", role, name)
    with changedOnce(node):
        node.RemoveAllColumns()
        node.SetUseColumnTitleAsColumnHeader(True)
        for column in columns:
            node.AddColumn(_array(column))
        node.SetLocked(True)
    return node


FEWEST_ROWS = 2
"""Of a table that is plotted: VTK logs an error for each painted line with fewer points, with or
without a pen, and Slicer plots all series as lines."""


def showPlotTable(scene: Any, role: str, name: str, columns: Sequence[Column]) -> Any:
    """Put columns that are plotted into a `vtkMRMLTableNode`; rows without values may follow."""
    missing = FEWEST_ROWS - min(len(column.values) for column in columns)
    padded = [
        Column(each.name, [*each.values, *[("" if each.isText else None)] * missing], each.isText)
        for each in columns
    ]
    return showTable(scene, role, name, padded)


def _array(column: Column) -> vtk.vtkAbstractArray:
    array = vtk.vtkStringArray() if column.isText else vtk.vtkDoubleArray()
    array.SetName(column.name)
    for value in column.values:
        array.InsertNextValue(value if column.isText else math.nan if value is None else value)
    return array


def showResiduals(
    scene: Any, registration: Registration, leaveOneOut: np.ndarray | None = None
) -> Any:
    """Show the residual of each fiducial in a `vtkMRMLTableNode` and return it.

    Args:
        registration: whose residuals are shown.
        leaveOneOut: (n,) float, mm, how far each touch lies from where the other pairs put it;
            None where there are too few pairs.
    """
    vectors = registration.residual_vectors_mm
    leftOut = [None] * len(registration.labels) if leaveOneOut is None else leaveOneOut
    return showTable(
        scene,
        Role.RESIDUALS,
        "Residuals",
        [
            Column("fiducial", registration.labels, isText=True),
            Column("residual (mm)", registration.residuals_mm),
            Column("residual R (mm)", vectors[:, 0]),
            Column("residual A (mm)", vectors[:, 1]),
            Column("residual S (mm)", vectors[:, 2]),
            Column("without it (mm)", leftOut),
        ],
    )


def showFits(
    scene: Any, fits: Sequence[Registration], targetErrors: Sequence[TargetError | None]
) -> Any:
    """Compare fits of the same points in a `vtkMRMLTableNode` and return it.

    Args:
        fits: one a row.
        targetErrors: of each fit, what to expect at the target; None where it is not known.
    """
    known = [(e.expected_mm, *e.interval_mm) if e else (None, None, None) for e in targetErrors]
    return showTable(
        scene,
        Role.FITS,
        "Fits",
        [
            Column("fit", [fit.kind for fit in fits], isText=True),
            Column("FRE (mm)", [fit.fre_mm for fit in fits]),
            Column("largest residual (mm)", [fit.residuals_mm.max() for fit in fits]),
            Column("expected TRE (mm)", [expected for expected, _low, _high in known]),
            Column("TRE from, 95 % (mm)", [low for _expected, low, _high in known]),
            Column("TRE to, 95 % (mm)", [high for _expected, _low, high in known]),
        ],
    )


BEST_SCORE = 100.0
FEWEST_SHOWN = 5.0
"""Trials for which there is room in the plot from the first one on."""
TRIAL_COLUMN = "trial"
SCORE_COLUMN = "score"
TIME_COLUMN = "completion time (s)"
_SERIES = {
    # Column, its title in the plot, color.
    SCORE_COLUMN: ("Score (0 to 100)", (0.15, 0.4, 0.75)),
    TIME_COLUMN: ("Completion time (s)", (0.85, 0.45, 0.1)),
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
            Column(TIME_COLUMN, [record.completion_time_s for record in records]),
            Column("FRE (mm)", [fit.fre_mm if fit else None for fit in rigid]),
            Column("expected TRE (mm)", [fit.expected_tre_mm if fit else None for fit in rigid]),
            Column("true TRE (mm)", [trial.true_tre_mm for trial in trials]),
            Column(SCORE_COLUMN, [t.score.score if t.score else None for t in trials]),
            Column("method", [record.method.value for record in records], isText=True),
        ],
    )


def showLearningCurve(scene: Any, pseudonym: str, trials: Sequence[StoredTrial]) -> Any:
    """Plot score and time over the trials in a `vtkMRMLPlotChartNode` and return it."""
    showHistory(scene, pseudonym, trials)
    table = showPlotTable(
        scene,
        Role.LEARNING_CURVE,
        f"Learning curve of {pseudonym}",
        [
            Column(TRIAL_COLUMN, range(1, len(trials) + 1)),
            Column(SCORE_COLUMN, [t.score.score if t.score else None for t in trials]),
            Column(TIME_COLUMN, [trial.record.completion_time_s for trial in trials]),
        ],
    )
    chart = findOrAddNode(
        scene, "vtkMRMLPlotChartNode", Role.LEARNING_CURVE, f"Learning curve of {pseudonym}"
    )
    chart.SetName(f"Learning curve of {pseudonym}")
    chart.RemoveAllPlotSeriesNodeIDs()
    for column, (title, color) in _SERIES.items():
        series = plotSeries(scene, table, Role.LEARNING_CURVE, TRIAL_COLUMN, column, title, color)
        chart.AddAndObservePlotSeriesNodeID(series.GetID())
    chart.SetTitle(_curveTitle(pseudonym, trials))
    chart.SetXAxisTitle("Trial")
    chart.SetYAxisTitle("Score, and completion time in s")
    chart.SetXAxisRangeAuto(False)
    chart.SetXAxisRange(0.0, max(FEWEST_SHOWN, len(trials) + 1.0))
    chart.SetYAxisRangeAuto(False)
    times = (trial.record.completion_time_s for trial in trials)
    chart.SetYAxisRange(0.0, 1.05 * max((BEST_SCORE, *times)))
    return chart


def _curveTitle(pseudonym: str, trials: Sequence[StoredTrial]) -> str:
    methods = sorted({trial.record.method.value for trial in trials if trial.score})
    title = f"Learning curve of {pseudonym}"
    if len(methods) < 2:
        return title
    return f"{title} (scores by {' and '.join(methods)} cannot be compared)"


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


EXPECTED = "expected TRE (mm)"
TRUE = "true TRE (mm)"
INSIDE = "true TRE, inside (mm)"
OUTSIDE = "true TRE, outside (mm)"
LOW, HIGH = "TRE from, 95 % (mm)", "TRE to, 95 % (mm)"
ROOM = 1.5
"""Of the plot's height to what it shows: the legend is above and hides no trial."""
_DOTS = {INSIDE: (_("Inside"), (0.15, 0.4, 0.75)), OUTSIDE: (_("Outside"), (0.8, 0.15, 0.1))}
_LINES = {
    TRUE: (_("True = expected"), (0.1, 0.1, 0.1)),
    LOW: (_("95 %, from"), (0.55, 0.6, 0.65)),
    HIGH: (_("95 %, to"), (0.55, 0.6, 0.65)),
}


def showCalibration(scene: Any, found: TreCalibration) -> Any:
    """Plot true over expected TRE in a `vtkMRMLPlotChartNode` and return it."""
    end = 1.1 * max((point.expected_mm for point in found.points), default=1.0)
    table, identity = _showCalibrationTable(scene, found), _showIdentity(scene, end)
    chart = findOrAddNode(
        scene, "vtkMRMLPlotChartNode", Role.CALIBRATION, "True against expected TRE"
    )
    chart.RemoveAllPlotSeriesNodeIDs()
    for column, (title, color) in {**_LINES, **_DOTS}.items():
        source = identity if column == TRUE else table
        series = plotSeries(scene, source, Role.CALIBRATION, EXPECTED, column, title, color)
        isLine = column in _LINES
        series.SetLineStyle(series.LineStyleDash if isLine else series.LineStyleNone)
        series.SetMarkerStyle(series.MarkerStyleNone if isLine else series.MarkerStyleCircle)
        chart.AddAndObservePlotSeriesNodeID(series.GetID())
    chart.SetTitle(_calibrationTitle(found))
    chart.SetXAxisTitle(_("Expected TRE (mm)"))
    chart.SetYAxisTitle(_("True TRE (mm)"))
    highest = [max(point.true_mm, point.interval_mm[1]) for point in found.points]
    chart.SetXAxisRangeAuto(False)
    chart.SetXAxisRange(0.0, end)
    chart.SetYAxisRangeAuto(False)
    chart.SetYAxisRange(0.0, ROOM * max(highest, default=1.0))
    return chart


def _showCalibrationTable(scene: Any, found: TreCalibration) -> Any:
    points = found.points
    return showPlotTable(
        scene,
        Role.CALIBRATION,
        "True and expected TRE",
        [
            Column("trainee", [point.trainee for point in points], isText=True),
            Column("mode", [point.mode for point in points], isText=True),
            Column("task", [point.task for point in points], isText=True),
            Column(EXPECTED, [point.expected_mm for point in points]),
            Column(LOW, [point.interval_mm[0] for point in points]),
            Column(HIGH, [point.interval_mm[1] for point in points]),
            Column(INSIDE, [point.true_mm if point.is_inside else None for point in points]),
            Column(OUTSIDE, [None if point.is_inside else point.true_mm for point in points]),
        ],
    )


def _showIdentity(scene: Any, end: float) -> Any:
    columns = [Column(name, [0.0, end]) for name in (EXPECTED, TRUE)]
    return showTable(scene, f"{Role.CALIBRATION} line", "True equals expected TRE", columns)


def _calibrationTitle(found: TreCalibration) -> str:
    from rastrainer.study.tre_calibration import share_text

    if found.inside is None:
        return _("True against expected TRE")
    return _("True against expected TRE: {count} of {total} inside, {share}").format(
        count=found.inside.count, total=found.inside.total, share=share_text(found.inside)
    )
