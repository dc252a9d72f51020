"""True against expected target error of a study's trials as a table and a plot."""

from __future__ import annotations

from typing import Any

from rastrainer.slicer.history_nodes import plotSeries
from rastrainer.slicer.scene import Role, findOrAddNode
from rastrainer.slicer.tables import Column, showTable
from rastrainer.slicer.translation import _
from rastrainer.tre_calibration import TreCalibration, share_text

EXPECTED = "expected TRE (mm)"
TRUE = "true TRE (mm)"
INSIDE = "true TRE, inside (mm)"
OUTSIDE = "true TRE, outside (mm)"
LOW, HIGH = "TRE from, 95 % (mm)", "TRE to, 95 % (mm)"
ROOM = 1.5
"""Of the plot's height to what it shows: the legend stands above, and hides no trial."""
_DOTS = {
    INSIDE: (_("Inside"), (0.15, 0.4, 0.75)),
    OUTSIDE: (_("Outside"), (0.8, 0.15, 0.1)),
}
_LINES = {
    TRUE: (_("True = expected"), (0.1, 0.1, 0.1)),
    LOW: (_("95 %, from"), (0.55, 0.6, 0.65)),
    HIGH: (_("95 %, to"), (0.55, 0.6, 0.65)),
}


def showCalibration(scene: Any, found: TreCalibration) -> Any:
    """Plot true over expected TRE in a `vtkMRMLPlotChartNode` and return it.

    Raises:
        InputError: scipy is missing.
    """
    end = 1.1 * max((point.expected_mm for point in found.points), default=1.0)
    table, identity = _showTable(scene, found), _showIdentity(scene, end)
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
    chart.SetTitle(_title(found))
    chart.SetXAxisTitle(_("Expected TRE (mm)"))
    chart.SetYAxisTitle(_("True TRE (mm)"))
    highest = [max(point.true_mm, point.interval_mm[1]) for point in found.points]
    chart.SetXAxisRangeAuto(False)
    chart.SetXAxisRange(0.0, end)
    chart.SetYAxisRangeAuto(False)
    chart.SetYAxisRange(0.0, ROOM * max(highest, default=1.0))
    return chart


def _showTable(scene: Any, found: TreCalibration) -> Any:
    points = found.points
    return showTable(
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
    """Show the ends of the line on which the true error is the expected one."""
    columns = [Column(name, [0.0, end]) for name in (EXPECTED, TRUE)]
    return showTable(scene, f"{Role.CALIBRATION} line", "True equals expected TRE", columns)


def _title(found: TreCalibration) -> str:
    if found.inside is None:
        return _("True against expected TRE")
    return _("True against expected TRE: {count} of {total} inside, {share}").format(
        count=found.inside.count, total=found.inside.total, share=share_text(found.inside)
    )
