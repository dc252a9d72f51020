"""The tour's second half: what is done with a trial, other scenarios, studies, and the end."""

from __future__ import annotations

import shutil

import slicer
from tour_stage import Tour
from tour_trial import STUDY, TRAINEE

PLAN_MM = (10.0, 20.0, 30.0)
SCENARIO_TIMEOUT_S = 600.0


def plan(tour: Tour) -> str:
    hands = tour.hands
    hands.open("planCollapsibleButton")
    hands.click("placeTargetButton")
    hands.find("planComboBox").currentNode().AddControlPoint(*PLAN_MM)
    interaction = slicer.app.applicationLogic().GetInteractionNode()
    interaction.SetCurrentInteractionMode(interaction.ViewTransform)
    hands.wait_until(lambda: hands.find("sendPlanButton").enabled, "the plan can be sent")
    hands.click("sendPlanButton")
    hands.wait_until(lambda: "shows the plan" in hands.text("reachableText"), "it is shown")
    return hands.text("reachableText")


def replay(tour: Tour) -> str:
    hands = tour.hands
    hands.open("scoreCollapsibleButton")
    hands.click("replayButton")
    hands.wait_until(lambda: slicer.util.getNodes("Replay of *"), "the replay is there")
    hands.wait_until(lambda: hands.find("worstTouchButton").enabled, "the replay is ready")
    hands.click("worstTouchButton")
    hands.wait_until(lambda: "clearance" in hands.text("replayText"), "it is told")
    return hands.text("replayText")


def tables_and_curve(tour: Tour) -> None:
    hands = tour.hands
    for name in ("showTablesButton", "learningCurveButton"):
        hands.open("traineesCollapsibleButton", "historyGroupBox")
        hands.click(name)
        hands.click(name)


def export(tour: Tour) -> str:
    hands, sizes = tour.hands, []
    hands.open("traineesCollapsibleButton", "historyGroupBox", "scoreCollapsibleButton")
    for button, caption, name in (
        ("exportTraineeButton", "Export the trainee", "trainee.json"),
        ("exportHistoryButton", "Export the history", "history.csv"),
        ("exportScoresButton", "Export all trials", "trials.csv"),
    ):
        path = tour.fresh(name)
        tour.dialogs.answer(caption, path)
        hands.click(button)
        hands.wait_until(path.is_file, f"{name} is written")
        sizes.append(f"{name}: {path.stat().st_size} bytes")
    return ", ".join(sizes)


def report(tour: Tour) -> str:
    hands, folder = tour.hands, tour.folder / "report"
    folder.mkdir(exist_ok=True)
    tour.dialogs.answer("Folder for the report", folder)
    hands.click("reportButton")
    hands.wait_until((folder / "report.html").is_file, "the report is written")
    return hands.text("scoreMessageText")


def save_and_load_scene(tour: Tour) -> str:
    hands, path = tour.hands, tour.fresh("scene.mrb")
    hands.must(slicer.util.saveScene(str(path)), "The scene is not saved.")
    slicer.mrmlScene.Clear(0)
    hands.let_pass(0.5)
    slicer.util.loadScene(str(path))
    hands.wait_until(lambda: hands.text("linkText") == "Connected", "it is connected again")
    hands.must(slicer.util.getNodes("*fiducials"), "The fiducials are not in the scene.")
    return f"{path.stat().st_size} bytes"


def scenario_from_volume(tour: Tour) -> str:
    hands = tour.hands
    hands.open("newScenarioCollapsibleButton")
    (volume,) = slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")
    hands.find("scanComboBox").setCurrentNode(volume)
    hands.find("titleLineEdit").text = "Head of the tour"
    hands.click("makeScenarioButton")
    combo = hands.find("scenarioComboBox")
    hands.wait_until(
        lambda: "Head of the tour" in combo.currentText, "it is made", SCENARIO_TIMEOUT_S
    )
    made = tour.session.places.library / combo.itemData(combo.currentIndex)
    told = hands.text("newScenarioText")
    hands.choose("scenarioComboBox", "Colin27")
    hands.click("loadScenarioButton")
    hands.let_pass(2.0)
    shutil.rmtree(made)
    return told


def study(tour: Tour) -> str:
    hands = tour.hands
    tour.choose_study(tour.fresh("led.db"))
    hands.open("studyCollapsibleButton")
    protocol = tour.session.places.assets / "studies" / "published-protocol.json"
    hands.find("protocolPathLineEdit").currentPath = str(protocol)
    tour.dialogs.answer("Begin the study", "Yes")
    hands.click("beginStudyButton")
    hands.click("createTraineeButton")
    hands.click("enrollButton")
    hands.wait_until(lambda: hands.find("stepsTable").rowCount, "the steps are listed")
    told = hands.text("stepText")
    leads = ("Answer", "Start the step", "Break")
    hands.wait_until(lambda: hands.text("nextStepButton") in leads, "the button leads on")
    return told


def delete_every_node(tour: Tour) -> str:
    hands, count = tour.hands, 0
    for node_id in [node.GetID() for node in slicer.util.getNodesByClass("vtkMRMLNode")]:
        node = slicer.mrmlScene.GetNodeByID(node_id)
        if node is not None and not node.GetSingletonTag():
            slicer.mrmlScene.RemoveNode(node)
            hands.let_pass(0.05)
            count += 1
    hands.wait_until(lambda: hands.text("linkText") == "Connected", "it is connected again")
    return f"{count} nodes"


def delete_trainee_and_stop(tour: Tour) -> str:
    hands = tour.hands
    tour.choose_study(tour.folder / STUDY)
    hands.choose("traineeComboBox", TRAINEE)
    tour.dialogs.answer("cannot be undone", "Yes")
    hands.click("deleteTraineeButton")
    hands.wait_until(lambda: "was deleted" in hands.text("traineeText"), "the trainee is deleted")
    told = hands.text("traineeText")
    hands.click("stopSimulatorButton")
    hands.wait_until(lambda: hands.text("nextStepButton") == "Start and connect", "it ends")
    return told
