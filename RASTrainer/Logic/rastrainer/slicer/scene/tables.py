"""Numbers and texts as table nodes, with the unit in each column's name, and plots of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import slicer
import vtk

from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, TABLE, Role, findOrAddNode, setValues
from rastrainer.slicer.translation import _
from rastrainer.study.database.values import StoredTrial

if TYPE_CHECKING:
    from rastrainer.study.tre_calibration import TreCalibration


Columns = Mapping[str, "Sequence[Any] | np.ndarray"]
FEWEST_ROWS = 2
"""Fewest rows of a plotted table: VTK logs an error for each line with fewer points, visible or
not, and Slicer plots every series as a line."""
EXPECTED, TRUE = "expected TRE (mm)", "true TRE (mm)"
LOW, HIGH = "TRE from, 95 % (mm)", "TRE to, 95 % (mm)"


def showTable(scene: Any, role: str, name: str, columns: Columns, fewestRows: int = 0) -> Any:
    """Put columns, texts or numbers or None, into the `vtkMRMLTableNode` of a role; return it.

    Rows without values follow where there are fewer than `fewestRows`.
    """
    node = findOrAddNode(scene, TABLE, role, name)
    with slicer.util.NodeModify(node):
        node.RemoveAllColumns()
        node.SetUseColumnTitleAsColumnHeader(True)
        for title, values in columns.items():
            isText = isinstance(next(iter(values), None), str)
            array = vtk.vtkStringArray() if isText else vtk.vtkDoubleArray()
            array.SetName(title)
            for value in (*values, *[None] * (fewestRows - len(values))):
                unknown = "" if isText else math.nan
                array.InsertNextValue(unknown if value is None else value)
            node.AddColumn(array)
        node.SetLocked(True)
    return node


def showResiduals(
    scene: Any, registration: Registration, leaveOneOut: np.ndarray | None = None
) -> Any:
    """Show the residual of each fiducial in a `vtkMRMLTableNode` and return it.

    `leaveOneOut` (n,), mm, is how far each touch lies from where the other pairs put it.
    """
    vectors = registration.residual_vectors_mm
    leftOut = [None] * len(registration.labels) if leaveOneOut is None else leaveOneOut
    columns: Columns = {
        "fiducial": registration.labels,
        "residual (mm)": registration.residuals_mm,
        **{f"residual {axis} (mm)": vectors[:, row] for row, axis in enumerate("RAS")},
        "without it (mm)": leftOut,
    }
    return showTable(scene, Role.RESIDUALS, "Residuals", columns)


def showFits(
    scene: Any, fits: Sequence[Registration], targetErrors: Sequence[TargetError | None]
) -> Any:
    """Compare fits of the same points, and what to expect at the target, in a table node."""
    known = [(e.expected_mm, *e.interval_mm) if e else (None, None, None) for e in targetErrors]
    columns: Columns = {
        "fit": [fit.kind for fit in fits],
        "FRE (mm)": [fit.fre_mm for fit in fits],
        "largest residual (mm)": [fit.residuals_mm.max() for fit in fits],
        EXPECTED: [expected for expected, _low, _high in known],
        LOW: [low for _expected, low, _high in known],
        HIGH: [high for _expected, _low, high in known],
    }
    return showTable(scene, Role.FITS, "Fits", columns)


BEST_SCORE = 100.0
FEWEST_SHOWN = 5.0
"""Trials for which there is room in the plot from the first one on."""
TRIAL_COLUMN = "trial"
SCORE_COLUMN = "score"
TIME_COLUMN = "completion time (s)"


def showHistory(scene: Any, pseudonym: str, trials: Sequence[StoredTrial]) -> Any:
    """Show the trials of a trainee in a `vtkMRMLTableNode`, one a row, and return it."""
    records = [trial.record for trial in trials]
    rigid = [trial.registrations.get(RIGID) for trial in trials]
    columns: Columns = {
        TRIAL_COLUMN: range(1, len(trials) + 1),
        "started (UTC)": [record.started_utc[:19] for record in records],
        "task": [record.task for record in records],
        "mode": [record.mode for record in records],
        TIME_COLUMN: [record.completion_time_s for record in records],
        "FRE (mm)": [fit.fre_mm if fit else None for fit in rigid],
        EXPECTED: [fit.expected_tre_mm if fit else None for fit in rigid],
        TRUE: [trial.true_tre_mm for trial in trials],
        SCORE_COLUMN: [trial.score.score if trial.score else None for trial in trials],
        "method": [record.method.value for record in records],
    }
    return showTable(scene, Role.HISTORY, f"History of {pseudonym}", columns, FEWEST_ROWS)


def showLearningCurve(scene: Any, pseudonym: str, trials: Sequence[StoredTrial]) -> Any:
    """Plot score and time over the trials in a `vtkMRMLPlotChartNode` and return it."""
    table = showHistory(scene, pseudonym, trials)
    title = f"Learning curve of {pseudonym}"
    chart = _emptyChart(scene, Role.LEARNING_CURVE, title)
    _addSeries(chart, table, TRIAL_COLUMN, SCORE_COLUMN, "Score (0 to 100)", (0.15, 0.4, 0.75))
    _addSeries(chart, table, TRIAL_COLUMN, TIME_COLUMN, "Completion time (s)", (0.85, 0.45, 0.1))
    methods = sorted({trial.record.method.value for trial in trials if trial.score})
    if len(methods) > 1:
        title += f" (scores by {' and '.join(methods)} cannot be compared)"
    setValues(chart, Title=title, XAxisTitle="Trial", YAxisTitle="Score, and completion time in s")
    times = [trial.record.completion_time_s for trial in trials]
    chart.SetXAxisRange(0.0, max(FEWEST_SHOWN, len(trials) + 1.0))
    chart.SetYAxisRange(0.0, 1.05 * max((BEST_SCORE, *times)))
    return chart


def _emptyChart(scene: Any, role: str, name: str) -> Any:
    chart = findOrAddNode(scene, "vtkMRMLPlotChartNode", role, name)
    chart.RemoveAllPlotSeriesNodeIDs()
    return setValues(chart, Name=name, XAxisRangeAuto=False, YAxisRangeAuto=False)


def _addSeries(
    chart: Any, table: Any, across: str, column: str, title: str, color: tuple[float, float, float]
) -> Any:
    """Draw a column of a table over another one, `across`; return the `vtkMRMLPlotSeriesNode`."""
    role = f"{chart.GetAttribute(ROLE_ATTRIBUTE)} {column}"
    node = findOrAddNode(chart.GetScene(), "vtkMRMLPlotSeriesNode", role, title)
    node.SetAndObserveTableNodeID(table.GetID())
    setValues(node, PlotType=node.PlotTypeScatter, XColumnName=across, YColumnName=column)
    setValues(node, Color=color, LineStyle=node.LineStyleSolid, MarkerStyle=node.MarkerStyleCircle)
    chart.AddAndObservePlotSeriesNodeID(node.GetID())
    return node


INSIDE = "true TRE, inside (mm)"
OUTSIDE = "true TRE, outside (mm)"
ROOM = 1.5
"""Ratio of the plot's height to its content: the legend lies above and hides no trial."""
_DOTS = {INSIDE: (_("Inside"), (0.15, 0.4, 0.75)), OUTSIDE: (_("Outside"), (0.8, 0.15, 0.1))}
_LINES = {
    TRUE: (_("True = expected"), (0.1, 0.1, 0.1)),
    LOW: (_("95 %, from"), (0.55, 0.6, 0.65)),
    HIGH: (_("95 %, to"), (0.55, 0.6, 0.65)),
}


def showCalibration(scene: Any, found: TreCalibration) -> Any:
    """Plot true over expected TRE in a `vtkMRMLPlotChartNode` and return it."""
    from rastrainer.study.tre_calibration import share_text

    points, role = found.points, Role.CALIBRATION
    columns: Columns = {
        "trainee": [point.trainee for point in points],
        "mode": [point.mode for point in points],
        "task": [point.task for point in points],
        EXPECTED: [point.expected_mm for point in points],
        LOW: [point.interval_mm[0] for point in points],
        HIGH: [point.interval_mm[1] for point in points],
        INSIDE: [point.true_mm if point.is_inside else None for point in points],
        OUTSIDE: [None if point.is_inside else point.true_mm for point in points],
    }
    table = showTable(scene, role, "True and expected TRE", columns, FEWEST_ROWS)
    end = 1.1 * max((point.expected_mm for point in points), default=1.0)
    ends = {EXPECTED: [0.0, end], TRUE: [0.0, end]}
    identity = showTable(scene, f"{role} line", "True equals expected TRE", ends)
    chart = _emptyChart(scene, role, "True against expected TRE")
    for column, (title, color) in {**_LINES, **_DOTS}.items():
        source = identity if column == TRUE else table
        series = _addSeries(chart, source, EXPECTED, column, title, color)
        if column in _LINES:
            setValues(series, LineStyle=series.LineStyleDash, MarkerStyle=series.MarkerStyleNone)
        else:
            series.SetLineStyle(series.LineStyleNone)
    title = _("True against expected TRE")
    if found.inside is not None:
        counted = _("True against expected TRE: {count} of {total} inside, {share}")
        inside, total = found.inside.count, found.inside.total
        title = counted.format(count=inside, total=total, share=share_text(found.inside))
    axes = {"XAxisTitle": _("Expected TRE (mm)"), "YAxisTitle": _("True TRE (mm)")}
    setValues(chart, Title=title, **axes)
    chart.SetXAxisRange(0.0, end)
    highest = [max(point.true_mm, point.interval_mm[1]) for point in points]
    chart.SetYAxisRange(0.0, ROOM * max(highest, default=1.0))
    return chart
