"""The lines of a procedure: planned, as the registration put them, and as they truly became."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import vtk

from rastrainer.procedure.errors import (
    PLACED_COLOR,
    PLANNED_COLOR,
    REGISTERED_COLOR,
    ProcedureAnalysis,
    SplitError,
    TrajectoryErrors,
)
from rastrainer.procedure.plan import Procedure
from rastrainer.slicer.scene.control_points import setPoints
from rastrainer.slicer.scene.error_colors import arrowPolyData
from rastrainer.slicer.scene.scene import (
    ROLE_ATTRIBUTE,
    Role,
    findOrAddNode,
    nodesOf,
    removeNode,
)
from rastrainer.slicer.scene.tables import Column, showTable
from rastrainer.slicer.translation import _

LINE, MODEL, TABLE = "vtkMRMLMarkupsLineNode", "vtkMRMLModelNode", "vtkMRMLTableNode"
TRAJECTORY_ATTRIBUTE = "RASTrainer.trajectory"
"""On a line: the name of its trajectory."""
THICKNESS = 0.3
"""Of the arrows, which are true to scale, as a factor on those of residuals."""


def showPlannedLines(scene: Any, procedure: Procedure | None) -> None:
    """Show the planned lines of a procedure, in the head, in place of those of another one.

    What was shown of an earlier procedure's errors goes. With None, nothing stays.
    """
    forgetProcedureErrors(scene)
    planned = [] if procedure is None else procedure.trajectories
    ends = [np.array([each.entry, each.target]) for each in planned]
    _showLines(scene, Role.PLANNED_LINE, "{}", [each.name for each in planned], ends)


def showProcedureErrors(scene: Any, analysis: ProcedureAnalysis) -> Any:
    """Show all lines of a procedure, arrows of its errors, and their table, which is returned.

    The registered lines are where the plan, as it was shown, truly lay in the head. The true lines
    go from the guide's tip to the instrument's. At entry and target, arrows lead from the planned
    point to where the registration put it, and from there on to what was reached; they are true to
    scale. All of it is in RAS mm.
    """
    each = analysis.trajectories
    names = [errors.trajectory.name for errors in each]
    planned = [np.array([e.trajectory.entry, e.trajectory.target]) for e in each]
    shown = [np.array([e.shown_entry, e.shown_target]) for e in each]
    placed = [np.array([e.axis_start, e.tip]) for e in each]
    _showLines(scene, Role.PLANNED_LINE, "{}", names, planned)
    _showLines(scene, Role.REGISTERED_LINE, _("{}, registered"), names, shown)
    _showLines(scene, Role.TRUE_LINE, _("{}, true"), names, placed)
    _showArrows(scene, each)
    return _showTable(scene, each)


def forgetProcedureErrors(scene: Any) -> None:
    """Remove what was shown of a procedure once its truth was known."""
    for role in (Role.REGISTERED_LINE, Role.TRUE_LINE):
        for node in nodesOf(scene, LINE, role):
            scene.RemoveNode(node)
    for role in (Role.ERRORS_BY_REGISTRATION, Role.ERRORS_BY_HAND):
        removeNode(scene, MODEL, role)
    removeNode(scene, TABLE, Role.PROCEDURE_ERRORS)


_COLORS = {
    Role.PLANNED_LINE: PLANNED_COLOR,
    Role.REGISTERED_LINE: REGISTERED_COLOR,
    Role.TRUE_LINE: PLACED_COLOR,
}


def _showLines(
    scene: Any, role: str, title: str, names: Sequence[str], ends: Sequence[np.ndarray]
) -> None:
    """Show lines of a role, one for each name; ends are (2, 3) float, RAS mm."""
    nodes = nodesOf(scene, LINE, role)
    for node in nodes[len(names) :]:
        scene.RemoveNode(node)
    for row, name in enumerate(names):
        node = nodes[row] if row < len(nodes) else _newLine(scene, role)
        if node.GetName() != title.format(name):
            node.SetName(title.format(name))
        node.SetAttribute(TRAJECTORY_ATTRIBUTE, name)
        # Only the planned lines show a label, at their entries.
        setPoints(node, (name, ""), ends[row])


def _newLine(scene: Any, role: str) -> Any:
    node = scene.AddNewNodeByClass(LINE)
    node.SetAttribute(ROLE_ATTRIBUTE, role)
    node.CreateDefaultDisplayNodes()
    node.SetLocked(True)
    display = node.GetDisplayNode()
    display.SetSelectedColor(_COLORS[role])
    display.SetPropertiesLabelVisibility(False)
    display.SetPointLabelsVisibility(role == Role.PLANNED_LINE)
    display.SetOccludedVisibility(True)
    display.SetGlyphScale(1.0)
    display.SetTextScale(2.5)
    return node


def _showArrows(scene: Any, each: Sequence[TrajectoryErrors]) -> None:
    for role, name, color in (
        (Role.ERRORS_BY_REGISTRATION, _("Errors by the registration"), REGISTERED_COLOR),
        (Role.ERRORS_BY_HAND, _("Errors by the hand"), PLACED_COLOR),
    ):
        append = vtk.vtkAppendPolyData()
        for errors in each:
            for start, split in (
                (errors.trajectory.entry, errors.entry),
                (errors.trajectory.target, errors.target),
            ):
                byRegistration = role == Role.ERRORS_BY_REGISTRATION
                begin = start if byRegistration else start + split.by_registration
                vector = split.by_registration if byRegistration else split.by_hand
                append.AddInputData(arrowPolyData(begin, vector, THICKNESS))
        append.Update()
        node = findOrAddNode(scene, MODEL, role, name)
        node.SetAndObservePolyData(append.GetOutput())
        node.GetDisplayNode().SetColor(color)
        node.GetDisplayNode().SetVisibility2D(True)


def _showTable(scene: Any, each: Sequence[TrajectoryErrors]) -> Any:
    def parts(title: str, splits: Sequence[SplitError]) -> list[Column]:
        return [
            Column(f"{title} (mm)", [split.length_mm for split in splits]),
            Column(f"{title}, by registration (mm)", [s.registration_mm for s in splits]),
            Column(f"{title}, by hand (mm)", [split.hand_mm for split in splits]),
        ]

    depths = [errors.depth for errors in each]
    return showTable(
        scene,
        Role.PROCEDURE_ERRORS,
        "Procedure errors",
        [
            Column("trajectory", [errors.trajectory.name for errors in each], isText=True),
            *parts("entry point error", [errors.entry for errors in each]),
            *parts("target point error", [errors.target for errors in each]),
            Column("radial error (mm)", [errors.radial.length_mm for errors in each]),
            Column("depth error (mm)", [whole for whole, _shown, _hand in depths]),
            Column("depth error, by registration (mm)", [shown for _whole, shown, _hand in depths]),
            Column("depth error, by hand (mm)", [hand for _whole, _shown, hand in depths]),
            Column("angular deviation (°)", [errors.angle_deg for errors in each]),
            Column("angle by registration (°)", [errors.registration_angle_deg for errors in each]),
            Column("angle by hand (°)", [errors.hand_angle_deg for errors in each]),
            Column("plunge depth (mm)", [errors.plunge_mm for errors in each]),
            Column(
                "distance kept (mm)",
                [min(errors.kept_mm.values(), default=None) for errors in each],
            ),
            Column("alignments", [float(errors.instrument.alignments) for errors in each]),
        ],
    )
