"""Numbers and texts as table nodes, with the unit in each column's name, and plots of them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import slicer
import vtk

from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.slicer.scene.nodes import Color, NodeKind, Role
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


def showTable(
    scene: Any, kind: NodeKind, columns: Columns, name: str = "", fewestRows: int = 0
) -> Any:
    """Put columns, texts or numbers or None, into the `vtkMRMLTableNode` of a kind; return it.

    Rows without values follow where there are fewer than `fewestRows`.
    """
    node = kind.make(scene, name)
    with slicer.util.NodeModify(node):
        node.RemoveAllColumns()
        node.SetUseColumnTitleAsColumnHeader(True)
        for title, values in columns.items():
            isText = isinstance(next(iter(values), None), str)
            array = vtk.vtkStringArray() if isText else vtk.vtkDoubleArray()
            array.SetName(title)
            for value in (*values, *[None] * (fewestRows - len(values))):
                # Where a saved row begins with an empty text, VTK cannot read it again.
                unknown = "-" if isText else math.nan
                array.InsertNextValue(unknown if value is None else value)
            node.AddColumn(array)
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
    return showTable(scene, Role.RESIDUALS, columns)


def showFits(
    scene: Any, fits: Mapping[str, Registration], errors: Mapping[str, TargetError | None]
) -> Any:
    """Compare fits of the same points, and what to expect at the target, in a table node."""
    known = [errors.get(kind) for kind in fits]
    columns: Columns = {
        "fit": list(fits),
        "FRE (mm)": [fit.fre_mm for fit in fits.values()],
        "largest residual (mm)": [fit.residuals_mm.max() for fit in fits.values()],
        EXPECTED: [error.expected_mm if error else None for error in known],
        LOW: [error.interval_mm[0] if error else None for error in known],
        HIGH: [error.interval_mm[1] if error else None for error in known],
    }
    return showTable(scene, Role.FITS, columns)


BEST_SCORE = 100.0
FEWEST_SHOWN = 5.0
"""Trials for which there is room in the plot from the first one on."""
TRIAL_COLUMN, SCORE_COLUMN, TIME_COLUMN = "trial", "score", "completion time (s)"
SERIES = slicer.vtkMRMLPlotSeriesNode
INSIDE, OUTSIDE = "true TRE, inside (mm)", "true TRE, outside (mm)"
ROOM = 1.5
"""Ratio of the plot's height to its content: the legend lies above and hides no trial."""
_LINE = {"LineStyle": SERIES.LineStyleSolid, "MarkerStyle": SERIES.MarkerStyleCircle}
_DASHES = {"LineStyle": SERIES.LineStyleDash, "MarkerStyle": SERIES.MarkerStyleNone}
_DOTS = {"LineStyle": SERIES.LineStyleNone, "MarkerStyle": SERIES.MarkerStyleCircle}


def _series(
    chart: NodeKind, across: str, look: dict[str, int], column: str, title: str, color: Color
) -> NodeKind:
    columns = {"XColumnName": across, "YColumnName": column, "Color": color}
    values = {"PlotType": SERIES.PlotTypeScatter, **look, **columns}
    return NodeKind("vtkMRMLPlotSeriesNode", f"{chart.role} {column}", title, {}, values)


_BLUE, _ORANGE, _RED = (0.15, 0.4, 0.75), (0.85, 0.45, 0.1), (0.8, 0.15, 0.1)
_GRAY, _BLACK = (0.55, 0.6, 0.65), (0.1, 0.1, 0.1)
_over_trials = partial(_series, Role.LEARNING_CURVE, TRIAL_COLUMN, _LINE)
_CURVES = (
    _over_trials(SCORE_COLUMN, "Score (0 to 100)", _BLUE),
    _over_trials(TIME_COLUMN, "Completion time (s)", _ORANGE),
)
_over_expected = partial(_series, Role.CALIBRATION, EXPECTED)
_IDENTITY = _over_expected(_DASHES, TRUE, _("True = expected"), _BLACK)
_CALIBRATION = (
    _over_expected(_DASHES, LOW, _("95 %, from"), _GRAY),
    _over_expected(_DASHES, HIGH, _("95 %, to"), _GRAY),
    _over_expected(_DOTS, INSIDE, _("Inside"), _BLUE),
    _over_expected(_DOTS, OUTSIDE, _("Outside"), _RED),
)


def _showChart(
    chart: Any, title: str, ends: tuple[float, float], tables: Mapping[NodeKind, Any]
) -> Any:
    """Have a chart show series, each from its table, along axes from 0 to these ends."""
    chart.SetTitle(title)
    chart.SetXAxisRange(0.0, ends[0])
    chart.SetYAxisRange(0.0, ends[1])
    chart.RemoveAllPlotSeriesNodeIDs()
    for kind, table in tables.items():
        series = kind.make(chart.GetScene())
        series.SetAndObserveTableNodeID(table.GetID())
        chart.AddAndObservePlotSeriesNodeID(series.GetID())
    return chart


def showLearningCurve(scene: Any, pseudonym: str, trials: Sequence[StoredTrial]) -> Any:
    """Plot score and time over the trials in a `vtkMRMLPlotChartNode` and return it."""
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
    showTable(scene, Role.HISTORY, columns, f"History of {pseudonym}")
    title = f"Learning curve of {pseudonym}"
    drawn = {name: columns[name] for name in (TRIAL_COLUMN, SCORE_COLUMN, TIME_COLUMN)}
    table = showTable(scene, Role.LEARNING_TABLE, drawn, title, FEWEST_ROWS)
    chart = Role.LEARNING_CURVE.make(scene, title)
    methods = sorted({trial.record.method.value for trial in trials if trial.score})
    if len(methods) > 1:
        title += f" (scores by {' and '.join(methods)} cannot be compared)"
    ends = max(FEWEST_SHOWN, len(trials) + 1.0), 1.05 * max((BEST_SCORE, *columns[TIME_COLUMN]))
    return _showChart(chart, title, ends, dict.fromkeys(_CURVES, table))


def showCalibration(scene: Any, found: TreCalibration) -> Any:
    """Plot true over expected TRE in a `vtkMRMLPlotChartNode` and return it."""
    from rastrainer.study.tre_calibration import share_text

    points = found.points
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
    table = showTable(scene, Role.CALIBRATION_TABLE, columns, fewestRows=FEWEST_ROWS)
    end = 1.1 * max((point.expected_mm for point in points), default=1.0)
    identity = {EXPECTED: [0.0, end], TRUE: [0.0, end]}
    tables = {_IDENTITY: showTable(scene, Role.CALIBRATION_LINE, identity)}
    title = _("True against expected TRE")
    if found.inside is not None:
        counted = _("True against expected TRE: {count} of {total} inside, {share}")
        inside, total = found.inside.count, found.inside.total
        title = counted.format(count=inside, total=total, share=share_text(found.inside))
    highest = max((max(point.true_mm, point.interval_mm[1]) for point in points), default=1.0)
    tables |= dict.fromkeys(_CALIBRATION, table)
    return _showChart(Role.CALIBRATION.make(scene), title, (end, ROOM * highest), tables)
