"""The section Plan: a target or trajectory on the MRI, carried to the robot."""

from __future__ import annotations

from functools import partial
from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.scenario_files import planArguments
from rastrainer.sections.target_plan_logic import PlanOnImages, targetsOf
from rastrainer.slicer.scene.nodes import NodeKind, Role
from rastrainer.slicer.scene.plan_points import startPlacing, whyNotRemoved
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    GRAY,
    GREEN,
    RED,
    CancelableWork,
    chosenData,
    fillComboBox,
    isFilled,
    numberOrDash,
    setEnabled,
    setLight,
    setText,
)
from rastrainer.widgets.plain_text import shortName


class PlanPanel(Panel):
    """The section Plan."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.plan
        failure = _("The plan was not saved.")
        self._keeping = CancelableWork(
            ui.keepPlanButton, self.save, failure, lambda _sentence: None, self.showState
        )
        noTarget, noLine = _("No target can be placed."), _("No trajectory can be placed.")
        connectClick(ui.placeTargetButton, partial(self._place, Role.PLAN_TARGET), noTarget)
        placeLine = partial(self._place, Role.PLAN_TRAJECTORY)
        connectClick(ui.placeTrajectoryButton, placeLine, noLine)
        connectClick(ui.removePlanPointButton, self.removePoint, _("The point was not removed."))
        connectClick(ui.undoPlanButton, self.undo, _("Nothing was undone."))
        connectClick(ui.sendPlanButton, self.send, _("The plan was not sent."))
        ui.planComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self._chooseNode)
        ui.planTargetComboBox.connect("activated(int)", self._chooseTarget)
        changes = self._logic.changed, session.registration.changed, session.link.statusChanged
        section = ui.planCollapsibleButton
        self.showWhileOpen(section, self.showState, *changes, session.sceneChanged)
        self.showState()

    def removePoint(self) -> None:
        """Remove the chosen target, or the last point of a trajectory."""
        self._logic.points.remove(self._ui.planComboBox.currentNode(), self._row())
        self.showState()

    def undo(self) -> None:
        self._logic.points.undo()
        self.showState()

    def send(self) -> None:
        self._logic.send(self._ui.planComboBox.currentNode(), self._row())

    def save(self) -> None:
        """Copy the scenario chosen above with this plan and use the copy."""
        ui, files = self._ui, self._session.scenarioFiles
        name, title = chosenData(ui.scenarioComboBox), ui.planTitleLineEdit.text.strip()
        plan = planArguments(ui.planComboBox.currentNode())
        scenario = self._keeping.run(lambda report: files.saveWith(plan, name, title, report))
        if scenario is not None:
            self._session.scenarioMade.emit(scenario.name)

    def showState(self, *_arguments: Any) -> None:
        plan, problem = self._read()
        self._logic.follow(plan)
        ui, logic, node = self._ui, self._logic, self._ui.planComboBox.currentNode()
        kept = whyNotRemoved(node)
        setEnabled(ui.removePlanPointButton, not kept, kept)
        unchanged = _("Nothing was placed or removed.")
        setEnabled(ui.undoPlanButton, logic.points.canUndo, unchanged)
        setText(ui.planWorldText, problem if plan is None else _place(plan))
        setText(ui.planTreText, "–" if plan is None else _expected(plan), INTERVAL_NOTE)
        problem = problem or _("Connect to the simulator first.")
        maySend = plan is not None and self._session.link.status.isConnected
        setEnabled(ui.sendPlanButton, maySend, problem)
        none = _("Place a target or a trajectory, or choose one.")
        setEnabled(ui.keepPlanButton, self._keeping.isUnderWay or node is not None, none)
        setLight(ui.reachableLight, {None: GRAY, True: GREEN, False: RED}[logic.isReachable])
        setText(ui.reachableText, logic.sentence or "–")
        unknown = _("known once the trial is scored and the plan is shown")
        true = logic.trueErrorMm
        setText(ui.planTrueText, unknown if true is None else numberOrDash(true, 2, "mm"))

    def _read(self) -> tuple[PlanOnImages | None, str]:
        """Return the plan, or why there is none."""
        node = self._ui.planComboBox.currentNode()
        if not isFilled(self._ui.planTargetComboBox, _entries(node)):
            self._offerTargets(node)
        try:
            return self._logic.read(node, self._row()), ""
        except InputError as error:
            return None, str(error)

    def _chooseNode(self, node: Any | None = None) -> None:
        self._offerTargets(node)
        self.showState()

    def _offerTargets(self, node: Any | None, row: int = -1) -> None:
        entries, box = _entries(node), self._ui.planTargetComboBox
        fillComboBox(box, entries, entries[row][1] if entries else "")
        box.enabled = len(entries) > 1

    def _chooseTarget(self, _index: int = 0) -> None:
        """Keep the user's choice, though a point was placed or removed while the list was open."""
        node, row = self._ui.planComboBox.currentNode(), self._row()
        chosen = self._ui.planTargetComboBox.currentText
        labels = [shortName(label) for label in targetsOf(node)]
        if chosen in labels:
            isSameRow = labels[row : row + 1] == [chosen]
            self._offerTargets(node, row if isSameRow else labels.index(chosen))
        self.showState()

    def _row(self) -> int:
        """Return which point of the chosen list is the target; the last of a line."""
        return int(chosenData(self._ui.planTargetComboBox) or -1)

    def _place(self, kind: NodeKind) -> None:
        node = self._logic.points.ready(kind)
        self._ui.planComboBox.setCurrentNode(node)
        startPlacing(slicer.mrmlScene, node)
        self.showState()


def _entries(node: Any | None) -> list[tuple[str, str]]:
    return [(label, str(row)) for row, label in enumerate(targetsOf(node))]


def _place(plan: PlanOnImages) -> str:
    *entry, target = (
        {axis: fixed(value, 1) for axis, value in zip("xyz", end, strict=True)}
        for end in plan.endsWorld
    )
    words = _("target x {x}, y {y}, z {z} mm").format(**target)
    if entry:
        words += _("; entry x {x}, y {y}, z {z} mm").format(**entry[0])
    return words


def _expected(plan: PlanOnImages) -> str:
    if plan.expected is None:
        return "–"
    low, high = plan.expected.interval_mm
    return _("{expected:.2f} mm (95 %: {low:.2f} to {high:.2f} mm)").format(
        expected=plan.expected.expected_mm, low=low, high=high
    )
