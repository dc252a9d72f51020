"""The tour's part on landmarks: shown, removed, placed, proposed, checked, and saved in a copy."""

from __future__ import annotations

from tour_stage import Tour

TITLE = "Landmarks of the tour"
OF_COLIN27 = 5
PLACED = "Right tragus"
PLACED_MM = (86.4, -8.2, -49.1)
"""Where the robot does not reach in every pose: the head's own landmarks lack it."""
SCENARIO_TIMEOUT_S = 600.0


def place(tour: Tour) -> str:
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
    tour.find("landmarksTitleLineEdit").text = TITLE
    tour.click("saveLandmarksButton")
    combo = tour.find("scenarioComboBox")
    tour.wait_until(lambda: combo.currentText == TITLE, "the copy is chosen", SCENARIO_TIMEOUT_S)
    tour.remove_chosen_scenario()
    return words
