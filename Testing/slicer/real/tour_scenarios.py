"""Other scenarios in the tour: one is passed on as a file, one is made from a volume."""

from __future__ import annotations

import slicer
from tour_stage import Tour

SCENARIO_TIMEOUT_S = 600.0


def zip_file(tour: Tour) -> str:
    """Save the scenario without its names, and add it again under its new name."""
    hands, path = tour.hands, tour.fresh("scenario.zip")
    hands.open("scenarioCollapsibleButton", "shareGroupBox")
    # Its tasks have fiducials on the face, which could not go without them.
    hands.check("removeFaceCheckBox", wanted=False)
    tour.dialogs.answer("Save the scenario", path)
    hands.click("exportScenarioButton")
    hands.wait_until(path.is_file, "the file is written", SCENARIO_TIMEOUT_S)
    hands.wait_for("scenarioText", "was written")
    text = hands.text("scenarioText")
    tour.dialogs.answer("Add a scenario", path)
    hands.click("importScenarioButton")
    hands.wait_for("scenarioText", "was added")
    hands.click("loadScenarioButton")
    tour.remove_chosen_scenario()
    return text


def compare_methods(tour: Tour) -> str:
    """Have one simulated trial registered by every method."""
    hands = tour.hands
    hands.open("scenarioCollapsibleButton", "methodsGroupBox")
    hands.find("methodTrialsSpinBox").value = 1
    hands.click("compareMethodsButton")
    table = hands.find("methodsTable")
    hands.wait_until(lambda: table.rowCount == 6, "they are compared", SCENARIO_TIMEOUT_S)
    return f"{table.item(0, 0).text()}: true TRE {table.item(0, 2).text()} mm"


def preview_and_check(tour: Tour) -> str:
    """Look for the head of a volume, and have the choices checked before anything is made."""
    hands = tour.hands
    hands.open("newScenarioCollapsibleButton", "adjustHeadGroupBox", "planForScenarioGroupBox")
    _choose_volume(tour)
    hands.click("previewHeadButton")
    text = "newScenarioText"
    hands.wait_for(text, "the head that was found", SCENARIO_TIMEOUT_S)
    hands.open("scenarioCollapsibleButton", "otherHeadGroupBox")
    hands.find("headModelComboBox").setCurrentNode(slicer.util.getNode("Head as found"))
    hands.click("useHeadButton")
    hands.wait_for("otherHeadText", "is now the head")
    hands.click("checkScenarioButton")
    hands.wait_for(text, "can be used", SCENARIO_TIMEOUT_S)
    return hands.text(text)


def scenario_from_volume(tour: Tour) -> str:
    hands = tour.hands
    hands.open("newScenarioCollapsibleButton")
    _choose_volume(tour)
    hands.click("makeScenarioButton")
    combo = hands.find("scenarioComboBox")
    hands.wait_until(
        lambda: "Head of the tour" in combo.currentText, "it is made", SCENARIO_TIMEOUT_S
    )
    text = hands.text("newScenarioText")
    tour.remove_chosen_scenario()
    return text


def _choose_volume(tour: Tour) -> None:
    """Choose the images of the scenario, as if they were a patient's."""
    hands = tour.hands
    (volume,) = slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")
    hands.find("scanComboBox").setCurrentNode(volume)
    hands.find("titleLineEdit").text = "Head of the tour"
    hands.idle_for(0.1)
