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
    hands, text = tour.hands, "landmarksText"
    hands.open("scenarioCollapsibleButton", "newScenarioCollapsibleButton", "landmarksGroupBox")
    table = hands.find("landmarksTable")
    hands.click("showLandmarksButton")
    hands.wait_until(lambda: table.rowCount == OF_COLIN27, "those of the scenario are listed")
    table.selectRow(0)
    hands.click("removeLandmarkButton")
    hands.wait_until(lambda: table.rowCount == OF_COLIN27 - 1, "one is removed")
    hands.click("undoLandmarkButton")
    hands.wait_until(lambda: table.rowCount == OF_COLIN27, "the landmark is back")
    hands.choose("landmarkNameComboBox", PLACED)
    hands.click("placeLandmarkButton")
    tour.place_active(PLACED_MM)
    hands.wait_until(lambda: table.rowCount == OF_COLIN27 + 1, "another one is placed")
    hands.click("undoLandmarkButton")
    hands.wait_until(lambda: table.rowCount == OF_COLIN27, "it is gone")
    hands.click("proposeLandmarksButton")
    hands.wait_for(text, "are proposed", SCENARIO_TIMEOUT_S)
    words = hands.text(text)
    hands.click("checkLandmarksButton")
    hands.wait_for(text, "can be used", SCENARIO_TIMEOUT_S)
    hands.find("landmarksTitleLineEdit").text = TITLE
    hands.click("saveLandmarksButton")
    combo = hands.find("scenarioComboBox")
    hands.wait_until(lambda: combo.currentText == TITLE, "the copy is chosen", SCENARIO_TIMEOUT_S)
    tour.remove_chosen_scenario()
    return words
