"""Other scenarios in the tour: with landmarks, passed on as a file, made from a volume."""

from __future__ import annotations

import slicer
from tour_stage import Tour

SCENARIO_TIMEOUT_S = 600.0
LANDMARKS_TITLE = "Landmarks of the tour"
OF_COLIN27 = 5
PLACED = "Right tragus"
PLACED_MM = (86.4, -8.2, -49.1)
"""Where the robot does not reach in every pose: the head's own landmarks lack it."""


def landmarks(tour: Tour) -> str:
    """Change the landmarks of the head and undo that; save proposed landmarks in a copy."""
    text = "landmarksText"
    tour.open("scenarioCollapsibleButton", "newScenarioCollapsibleButton", "landmarksGroupBox")
    table = tour.find("landmarksTable")
    tour.click("showLandmarksButton")
    tour.wait_until(lambda: table.rowCount == OF_COLIN27, "those of the scenario are listed")
    table.selectRow(0)
    tour.click("removeLandmarkButton")
    tour.wait_until(lambda: table.rowCount == OF_COLIN27 - 1, "one is removed")
    tour.click("undoLandmarkButton")
    tour.wait_until(lambda: table.rowCount == OF_COLIN27, "the landmark is back")
    tour.choose("landmarkNameComboBox", PLACED)
    tour.click("placeLandmarkButton")
    tour.place_active(PLACED_MM)
    tour.wait_until(lambda: table.rowCount == OF_COLIN27 + 1, "another one is placed")
    tour.click("undoLandmarkButton")
    tour.wait_until(lambda: table.rowCount == OF_COLIN27, "it is gone")
    tour.click("proposeLandmarksButton")
    tour.wait_for(text, "are proposed", SCENARIO_TIMEOUT_S)
    words = tour.text(text)
    tour.click("checkLandmarksButton")
    tour.wait_for(text, "can be used", SCENARIO_TIMEOUT_S)
    tour.find("landmarksTitleLineEdit").text = LANDMARKS_TITLE
    tour.click("saveLandmarksButton")
    combo = tour.find("scenarioComboBox")
    tour.wait_until(
        lambda: combo.currentText == LANDMARKS_TITLE, "the copy is chosen", SCENARIO_TIMEOUT_S
    )
    tour.remove_chosen_scenario()
    return words


def zip_file(tour: Tour) -> str:
    """Save the scenario without its names, and add it again under its new name."""
    path = tour.fresh("scenario.zip")
    tour.open("scenarioCollapsibleButton", "shareGroupBox")
    # Its tasks have fiducials on the face, which could not go without them.
    tour.check("removeFaceCheckBox", wanted=False)
    tour.dialogs.answer("Save the scenario", path)
    tour.click("exportScenarioButton")
    tour.wait_until(path.is_file, "the file is written", SCENARIO_TIMEOUT_S)
    tour.wait_for("scenarioText", "was written")
    text = tour.text("scenarioText")
    tour.dialogs.answer("Add a scenario", path)
    tour.click("importScenarioButton")
    tour.wait_for("scenarioText", "was added")
    tour.click("loadScenarioButton")
    tour.remove_chosen_scenario()
    return text


def compare_methods(tour: Tour) -> str:
    """Have one simulated trial registered by every method."""
    tour.open("scenarioCollapsibleButton", "methodsGroupBox")
    tour.find("methodTrialsSpinBox").value = 1
    tour.click("compareMethodsButton")
    table = tour.find("methodsTable")
    tour.wait_until(lambda: table.rowCount == 6, "they are compared", SCENARIO_TIMEOUT_S)
    return f"{table.item(0, 0).text()}: true TRE {table.item(0, 2).text()} mm"


def preview_and_check(tour: Tour) -> str:
    """Look for the head of a volume, and have the choices checked before anything is made."""
    tour.open("newScenarioCollapsibleButton", "adjustHeadGroupBox", "planForScenarioGroupBox")
    _choose_volume(tour)
    tour.click("previewHeadButton")
    text = "newScenarioText"
    tour.wait_for(text, "the head that was found", SCENARIO_TIMEOUT_S)
    tour.open("scenarioCollapsibleButton", "otherHeadGroupBox")
    tour.find("headModelComboBox").setCurrentNode(slicer.util.getNode("Head as found"))
    tour.click("useHeadButton")
    tour.wait_for("otherHeadText", "is now the head")
    tour.click("checkScenarioButton")
    tour.wait_for(text, "can be used", SCENARIO_TIMEOUT_S)
    return tour.text(text)


def scenario_from_volume(tour: Tour) -> str:
    tour.open("newScenarioCollapsibleButton")
    _choose_volume(tour)
    tour.click("makeScenarioButton")
    combo = tour.find("scenarioComboBox")
    tour.wait_until(
        lambda: "Head of the tour" in combo.currentText, "it is made", SCENARIO_TIMEOUT_S
    )
    text = tour.text("newScenarioText")
    tour.remove_chosen_scenario()
    return text


def _choose_volume(tour: Tour) -> None:
    """Choose the images of the scenario, as if they were a patient's."""
    (volume,) = slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")
    tour.find("scanComboBox").setCurrentNode(volume)
    tour.find("titleLineEdit").text = "Head of the tour"
    tour.idle_for(0.1)
