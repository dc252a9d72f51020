"""The section Plan: a target or trajectory on the MRI, carried to the robot."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.panels.widgets import (
    GRAY,
    GREEN,
    RED,
    chosenData,
    fillComboBox,
    light,
    millimeters,
    setUsable,
)
from rastrainer.slicer.heartbeat import LinkState
from rastrainer.slicer.placing import startPlacing
from rastrainer.slicer.plan_desk import Plan, targetsOf
from rastrainer.slicer.registration_input import snapshot
from rastrainer.slicer.session import Session
from rastrainer.slicer.translation import _


class PlanPanel:
    """Wires the section's widgets to the session."""

    def __init__(self, ui: Any, session: Session) -> None:
        self._ui = ui
        self._session = session
        self._desk = session.plan
        self._offered: tuple = ()
        self._seen: tuple = ()
        self._known: tuple[Plan | None, str] = (None, "")
        ui.placeTargetButton.connect("clicked()", self.placeTarget)
        ui.placeTrajectoryButton.connect("clicked()", self.placeTrajectory)
        ui.sendPlanButton.connect("clicked()", self.send)
        ui.keepPlanButton.connect("clicked()", self.keep)
        ui.planComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self.showState)
        ui.planTargetComboBox.connect("activated(int)", self.showState)
        self._listening = (
            (self._desk.changed, self.showState),
            (session.registration.changed, self.showState),
            (session.link.statusChanged, self.showState),
        )
        for signal, slot in self._listening:
            signal.connect(slot)
        self.showState()

    def close(self) -> None:
        """Listen to the session no more."""
        for signal, slot in self._listening:
            signal.disconnect(slot)

    def placeTarget(self) -> None:
        """Let the next click in a view place the target."""
        with slicer.util.tryWithErrorDisplay(_("No target can be placed.")):
            self._place(self._desk.newTarget())

    def placeTrajectory(self) -> None:
        """Let the next two clicks place a trajectory, from its entry to the target."""
        with slicer.util.tryWithErrorDisplay(_("No trajectory can be placed.")):
            self._place(self._desk.newTrajectory())

    def send(self) -> None:
        """Show the plan in the simulator and ask whether the robot can carry it out."""
        with slicer.util.tryWithErrorDisplay(_("The plan was not sent.")):
            self._desk.send(self._ui.planComboBox.currentNode(), self._row())

    def keep(self) -> None:
        """Copy the scenario that is chosen above with this plan, and go on with the copy."""
        with slicer.util.tryWithErrorDisplay(_("The plan was not kept."), waitCursor=True):
            ui = self._ui
            scenario = self._session.scenarioFiles.keepPlan(
                chosenData(ui.scenarioComboBox),
                ui.planTitleLineEdit.text.strip(),
                ui.planComboBox.currentNode(),
                ui.programPathLineEdit.currentPath,
            )
            self._session.scenarioMade.emit(scenario.name)

    def showState(self, *_arguments: Any) -> None:
        """Show the plan as it stands; called about ten times a second."""
        plan, problem = self._read()
        ui = self._ui
        ui.planWorldText.text = problem if plan is None else _place(plan)
        ui.planTreText.text = "–" if plan is None else _expected(plan)
        isConnected = self._session.link.status.state is LinkState.CONNECTED
        setUsable(
            ui.sendPlanButton,
            plan is not None and isConnected,
            _("Show the plan to the trainee, and ask whether the robot can carry it out."),
            problem or _("Connect to the simulator first."),
        )
        setUsable(
            ui.keepPlanButton,
            ui.planComboBox.currentNode() is not None,
            _("Copy the scenario above with this plan in the place of its targets or trajectory."),
            _("Place a target or a trajectory, or choose one."),
        )
        color = {None: GRAY, True: GREEN, False: RED}[self._desk.isReachable]
        sentence = self._desk.sentence
        ui.reachableText.text = f"{light(color)} {sentence}" if sentence else "–"
        isTold = self._desk.trueErrorMm is not None
        ui.planTrueText.text = (
            millimeters(self._desk.trueErrorMm)
            if isTold
            else _("told once the trial is scored and the plan is shown")
        )

    def _read(self) -> tuple[Plan | None, str]:
        """Return the plan, or why there is none; computed anew only where something changed."""
        node = self._ui.planComboBox.currentNode()
        self._offerTargets(node)
        row = self._row()
        placed = node.GetNumberOfDefinedControlPoints() if node is not None else 0
        registration = self._session.registration
        seen = (snapshot(node), placed, row, registration.shown, registration.problem)
        if seen != self._seen:
            self._seen = seen
            try:
                self._known = self._desk.read(node, row), ""
            except InputError as error:
                self._known = None, str(error)
        return self._known

    def _offerTargets(self, node: Any | None) -> None:
        """Offer the points of a list as targets; where they change, the last is chosen."""
        labels = targetsOf(node)
        if (node, labels) != self._offered:
            self._offered = (node, labels)
            entries = [(label, str(row)) for row, label in enumerate(labels)]
            fillComboBox(self._ui.planTargetComboBox, entries, str(len(labels) - 1))
            self._ui.planTargetComboBox.enabled = len(labels) > 1

    def _row(self) -> int:
        """Return which point of the chosen list is the target; the last of a line."""
        return int(chosenData(self._ui.planTargetComboBox) or -1)

    def _place(self, node: Any) -> None:
        self._ui.planComboBox.setCurrentNode(node)
        startPlacing(slicer.mrmlScene, node)
        self.showState()


def _place(plan: Plan) -> str:
    x, y, z = plan.targetWorld
    words = _("target x {x:.1f}, y {y:.1f}, z {z:.1f} mm").format(x=x, y=y, z=z)
    if plan.entryWorld is not None:
        x, y, z = plan.entryWorld
        words += _("; entry x {x:.1f}, y {y:.1f}, z {z:.1f} mm").format(x=x, y=y, z=z)
    return words


def _expected(plan: Plan) -> str:
    if plan.expected is None:
        return "–"
    low, high = plan.expected.interval_mm
    return _("{expected:.2f} mm (95 %: {low:.2f} to {high:.2f} mm)").format(
        expected=plan.expected.expected_mm, low=low, high=high
    )
