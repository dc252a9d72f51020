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
        for button, kind, failure in (
            (ui.placeTargetButton, Role.PLAN_TARGET, _("No target can be placed.")),
            (ui.placeTrajectoryButton, Role.PLAN_TRAJECTORY, _("No trajectory can be placed.")),
        ):
            connectClick(button, partial(self._place, kind), failure)
        logic, failure = self._logic, _("The point was not removed.")
        remove = ui.removePlanPointButton
        connectClick(remove, lambda: logic.points.removePoint(*self._chosen()), failure)
        connectClick(ui.undoPlanButton, logic.points.undo, _("Nothing was undone."))
        for button in (remove, ui.undoPlanButton):
            button.connect("clicked()", self.showState)
        notSent = _("The plan was not sent.")
        connectClick(ui.sendPlanButton, lambda: logic.send(*self._chosen()), notSent)
        for show in (self._offerTargets, self.showState):
            ui.planComboBox.connect("currentNodeChanged(vtkMRMLNode*)", show)
        ui.planTargetComboBox.connect("activated(int)", self._chooseTarget)
        changes = self._logic.changed, session.registration.changed, session.link.statusChanged
        section = ui.planCollapsibleButton
        self.showWhileOpen(section, self.showState, *changes, session.sceneChanged)
        self.showState()

    def _chosen(self) -> tuple[Any | None, int]:
        """Return the chosen list or line, and the row of its target, −1 for a line."""
        row = int(chosenData(self._ui.planTargetComboBox) or -1)
        return self._ui.planComboBox.currentNode(), row

    def save(self) -> None:
        plan = planArguments(self._ui.planComboBox.currentNode())
        self.saveCopy(self._keeping, self._ui.planTitleLineEdit.text, plan)

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
        true, unknown = logic.trueErrorMm, _("known once the trial is scored and the plan is shown")
        setText(ui.planTrueText, unknown if true is None else numberOrDash(true, 2, "mm"))

    def _read(self) -> tuple[PlanOnImages | None, str]:
        """Return the plan, or why there is none."""
        node = self._ui.planComboBox.currentNode()
        if not isFilled(self._ui.planTargetComboBox, _entries(node)):
            self._offerTargets(node)
        try:
            return self._logic.read(*self._chosen()), ""
        except InputError as error:
            return None, str(error)

    def _offerTargets(self, node: Any | None, row: int = -1) -> None:
        entries, box = _entries(node), self._ui.planTargetComboBox
        fillComboBox(box, entries, entries[row][1] if entries else "")
        box.enabled = len(entries) > 1

    def _chooseTarget(self, _index: int = 0) -> None:
        """Keep the user's choice, though a point was placed or removed while the list was open."""
        node, row = self._chosen()
        chosen = self._ui.planTargetComboBox.currentText
        labels = [shortName(label) for label in targetsOf(node)]
        if chosen in labels:
            isSameRow = labels[row : row + 1] == [chosen]
            self._offerTargets(node, row if isSameRow else labels.index(chosen))
        self.showState()

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
