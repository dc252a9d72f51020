"""The tour's part on procedures: one is planned, then carried out on a head that was registered."""

from __future__ import annotations

import slicer
from tour_stage import Tour

PROCEDURE = "Biopsy"
STRUCTURE = "Superior sagittal sinus (schematic)"
SECOND_LINE_MM = (45.0, 44.0, 62.0), (34.0, 26.0, 26.0)
"""Entry and target of a line next to the scenario's line; the robot need not reach it."""
CHECKPOINT = 3
TITLE = "Procedure of the tour"
SCENARIO_TIMEOUT_S = 600.0


def plan(tour: Tour) -> str:
    """Add a line to a procedure and remove it, measure the rest, and save that in a copy."""
    hands, text = tour.hands, "procedurePlanText"
    hands.open("scenarioCollapsibleButton", "procedurePlanCollapsibleButton")
    hands.click("showScenarioButton")
    hands.choose("procedurePlanComboBox", PROCEDURE)
    hands.click("editProcedureButton")
    table = hands.find("linesTable")
    hands.wait_until(lambda: table.rowCount == 1, "its line is listed")
    hands.click("placeLineButton")
    tour.place_active(*SECOND_LINE_MM)
    hands.wait_until(lambda: table.rowCount == 2, "the new line is listed")
    hands.wait_until(lambda: table.item(1, 1).text() != "–", "its length is measured")
    table.selectRow(1)
    hands.click("removeLineButton")
    hands.wait_until(lambda: table.rowCount == 1, "it is removed")
    hands.find("noGoComboBox").setCurrentNode(slicer.util.getNode(STRUCTURE))
    for is_kept in (False, True):
        hands.click("noGoButton")
        is_told = STRUCTURE in hands.text("noGoText")
        hands.must(is_told == is_kept, "The structure stays as it was.")
    hands.click("checkLinesButton")
    hands.wait_for(text, "can be carried out", SCENARIO_TIMEOUT_S)
    words = f"angle {table.item(0, 2).text()}°, {table.item(0, 3).text()}"
    hands.find("procedureScenarioLineEdit").text = TITLE
    hands.click("saveProcedureButton")
    combo = hands.find("scenarioComboBox")
    hands.wait_until(lambda: combo.currentText == TITLE, "the copy is chosen", SCENARIO_TIMEOUT_S)
    tour.remove_chosen_scenario()
    return words


def start(tour: Tour) -> str:
    """Start the task with a procedure, and touch and register its points."""
    hands = tour.hands
    hands.open("trainingCollapsibleButton", "procedureCollapsibleButton")
    hands.choose("taskComboBox", "Task 1")
    hands.choose("procedureComboBox", PROCEDURE)
    hands.click("startTaskButton")
    hands.wait_for("nextStepButton", "Pause")
    _touch_all(tour)
    return hands.text("procedureStateText")


def _touch_all(tour: Tour) -> None:
    tour.play("--points", "1", "15", "--register")
    accept = tour.hands.find("acceptButton")
    tour.hands.wait_until(lambda: accept.enabled, "the touches are registered")


def verify(tour: Tour) -> str:
    """Touch all points once more, and accept the second registration after a checkpoint."""
    hands = tour.hands
    hands.click("registerAgainButton")
    hands.wait_until(
        lambda: hands.find("pointsProgressBar").value == 0, "all points are open again"
    )
    _touch_all(tour)
    tour.play("--checkpoint", str(CHECKPOINT))
    text = "procedureInstructionText"
    hands.wait_for(text, "checkpoint was")
    words = hands.text(text)
    hands.click("acceptButton")
    hands.wait_enabled("alignButton")
    return words


def align(tour: Tour) -> str:
    """Let the robot align the guide, and lock it; then take the drill out to align it again."""
    hands = tour.hands
    state = _align_and_lock(tour)
    hands.click("retractDrillButton")
    hands.wait_enabled("alignButton")
    _align_and_lock(tour)
    return state


def _align_and_lock(tour: Tour) -> str:
    hands, state = tour.hands, "procedureStateText"
    hands.click("alignButton")
    hands.wait_for(state, "0.00 mm and 0.00°")
    text = hands.text(state)
    hands.click("lockButton")
    hands.wait_enabled("advanceButton")
    return text


def drill(tour: Tour) -> str:
    """Advance and withdraw the drill by the buttons, then let the trainee drill."""
    hands, state = tour.hands, "procedureStateText"
    _advance_and_withdraw(tour)
    _watch_slices(tour)
    tour.play("--drill")
    text = hands.text(state)
    hands.click("startInsertionButton")
    hands.wait_enabled("releaseButton")
    return text


def insert(tour: Tour) -> str:
    """Let the trainee insert the instrument, release it, and read the errors."""
    hands = tour.hands
    _advance_and_withdraw(tour)
    tour.play("--insert")
    hands.click("releaseButton")
    table, text = hands.find("procedureErrorsTable"), "procedureScoreText"
    hands.wait_until(lambda: table.rowCount == 1 and hands.text(text), "the errors are shown")
    hands.must("Not acceptable" not in hands.text(text), hands.text(text))
    table.selectRow(0)
    hands.wait_for("nextStepButton", "Show result")
    hands.click("nextStepButton")
    hands.open("procedureCollapsibleButton")
    hands.choose("procedureComboBox", "none")
    return f"target {table.item(0, 1).text()} mm. {hands.text(text)}"


def _advance_and_withdraw(tour: Tour) -> None:
    hands, state = tour.hands, "procedureStateText"
    before = hands.text(state)
    hands.click("advanceButton")
    hands.wait_until(lambda: ": 1.0 mm" in hands.text(state), f"the state changes from {before}")
    hands.click("withdrawButton")
    hands.wait_for(state, ": 0.0 mm")


def _watch_slices(tour: Tour) -> None:
    """Have the slices lie along the drill, as before, and along it again."""
    if slicer.util.mainWindow() is None:
        return
    hands, along = tour.hands, _red_axes()
    hands.check("slicesAlongCheckBox", wanted=False)
    hands.wait_until(lambda: _red_axes() != along, "the slices lie as before")
    hands.check("slicesAlongCheckBox")
    hands.wait_until(lambda: _red_axes() == along, "the slices lie along the drill again")


def _red_axes() -> list[float]:
    """Return the axes of the red slice view, each component to a thousandth."""
    matrix = slicer.mrmlScene.GetNodeByID("vtkMRMLSliceNodeRed").GetSliceToRAS()
    return [round(matrix.GetElement(row, column), 3) for row in range(3) for column in range(3)]
