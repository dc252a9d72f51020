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
    text = "procedurePlanText"
    tour.open("scenarioCollapsibleButton", "procedurePlanCollapsibleButton")
    tour.click("showScenarioButton")
    tour.choose("procedurePlanComboBox", PROCEDURE)
    tour.click("editProcedureButton")
    table = tour.find("linesTable")
    tour.wait_until(lambda: table.rowCount == 1, "its line is listed")
    tour.click("placeLineButton")
    tour.place_active(*SECOND_LINE_MM)
    tour.wait_until(lambda: table.rowCount == 2, "the new line is listed")
    tour.wait_until(lambda: table.item(1, 1).text() != "–", "its length is measured")
    table.selectRow(1)
    tour.click("removeLineButton")
    tour.wait_until(lambda: table.rowCount == 1, "it is removed")
    tour.find("noGoComboBox").setCurrentNode(slicer.util.getNode(STRUCTURE))
    for is_kept in (False, True):
        tour.click("noGoButton")
        is_told = STRUCTURE in tour.text("noGoText")
        tour.must(is_told == is_kept, "The structure stays as it was.")
    tour.click("checkLinesButton")
    tour.wait_for(text, "can be carried out", SCENARIO_TIMEOUT_S)
    words = f"angle {table.item(0, 2).text()}°, {table.item(0, 3).text()}"
    tour.find("procedureScenarioLineEdit").text = TITLE
    tour.click("saveProcedureButton")
    combo = tour.find("scenarioComboBox")
    tour.wait_until(lambda: combo.currentText == TITLE, "the copy is chosen", SCENARIO_TIMEOUT_S)
    tour.remove_chosen_scenario()
    return words


def start(tour: Tour) -> str:
    """Start the task with a procedure, and touch and register its points."""
    tour.open("trainingCollapsibleButton", "procedureCollapsibleButton")
    tour.choose("taskComboBox", "Task 1")
    tour.choose("procedureComboBox", PROCEDURE)
    tour.click("startTaskButton")
    tour.wait_for("nextStepButton", "Pause")
    _touch_all(tour)
    return tour.text("procedureStateText")


def _touch_all(tour: Tour) -> None:
    tour.play("--points", "1", "15", "--register")
    accept = tour.find("acceptButton")
    tour.wait_until(lambda: accept.enabled, "the touches are registered")


def verify(tour: Tour) -> str:
    """Touch all points once more, and accept the second registration after a checkpoint."""
    tour.click("registerAgainButton")
    tour.wait_until(lambda: tour.find("pointsProgressBar").value == 0, "all points are open again")
    _touch_all(tour)
    tour.play("--checkpoint", str(CHECKPOINT))
    text = "procedureInstructionText"
    tour.wait_for(text, "checkpoint was")
    words = tour.text(text)
    tour.click("acceptButton")
    tour.wait_enabled("alignButton")
    return words


def align(tour: Tour) -> str:
    """Let the robot align the guide, and lock it; then take the drill out to align it again."""
    state = _align_and_lock(tour)
    tour.click("retractDrillButton")
    tour.wait_enabled("alignButton")
    _align_and_lock(tour)
    return state


def _align_and_lock(tour: Tour) -> str:
    state = "procedureStateText"
    tour.click("alignButton")
    tour.wait_for(state, "0.00 mm and 0.00°")
    text = tour.text(state)
    tour.click("lockButton")
    tour.wait_enabled("advanceButton")
    return text


def drill(tour: Tour) -> str:
    """Advance and withdraw the drill by the buttons, then let the trainee drill."""
    state = "procedureStateText"
    _advance_and_withdraw(tour)
    _watch_slices(tour)
    tour.play("--drill")
    text = tour.text(state)
    tour.click("startInsertionButton")
    tour.wait_enabled("releaseButton")
    return text


def insert(tour: Tour) -> str:
    """Let the trainee insert the instrument, release it, and read the errors."""
    _advance_and_withdraw(tour)
    tour.play("--insert")
    tour.click("releaseButton")
    table, text = tour.find("procedureErrorsTable"), "procedureScoreText"
    tour.wait_until(lambda: table.rowCount == 1 and tour.text(text), "the errors are shown")
    tour.must("Not acceptable" not in tour.text(text), tour.text(text))
    table.selectRow(0)
    tour.wait_for("nextStepButton", "Show result")
    tour.click("nextStepButton")
    tour.open("procedureCollapsibleButton")
    tour.choose("procedureComboBox", "none")
    return f"target {table.item(0, 1).text()} mm. {tour.text(text)}"


def _advance_and_withdraw(tour: Tour) -> None:
    state = "procedureStateText"
    before = tour.text(state)
    tour.click("advanceButton")
    tour.wait_until(lambda: ": 1.0 mm" in tour.text(state), f"the state changes from {before}")
    tour.click("withdrawButton")
    tour.wait_for(state, ": 0.0 mm")


def _watch_slices(tour: Tour) -> None:
    """Have the slices lie along the drill, as before, and along it again."""
    if slicer.util.mainWindow() is None:
        return
    along = _red_axes()
    tour.check("slicesAlongCheckBox", wanted=False)
    tour.wait_until(lambda: _red_axes() != along, "the slices lie as before")
    tour.check("slicesAlongCheckBox")
    tour.wait_until(lambda: _red_axes() == along, "the slices lie along the drill again")


def _red_axes() -> list[float]:
    """Return the axes of the red slice view, each component to a thousandth."""
    matrix = slicer.mrmlScene.GetNodeByID("vtkMRMLSliceNodeRed").GetSliceToRAS()
    return [round(matrix.GetElement(row, column), 3) for row in range(3) for column in range(3)]
