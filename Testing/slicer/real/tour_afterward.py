"""The tour's second half: what is done with a trial, other scenarios, studies, and the end."""

from __future__ import annotations

import os
import subprocess

import slicer
from tour_stage import Tour
from tour_trial import STUDY, TRAINEE

PLAN_MM = (10.0, 20.0, 30.0)
TRAJECTORY_MM = (39.79, 48.41, 61.59), (28.0, 30.0, 24.0)
"""Entry and target of the planned biopsy of the built-in head, which the robot can carry out."""
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
    told, plan = hands.text("reachableText"), hands.find("planComboBox").currentNode()
    hands.click("removePlanPointButton")
    hands.must(plan.GetNumberOfControlPoints() == 0, "The target is not removed.")
    hands.click("undoPlanButton")
    hands.must(plan.GetNumberOfControlPoints() == 1, "The target is not brought back.")
    return told


def keep_trajectory(tour: Tour) -> str:
    """Place a trajectory by two points, and keep it in a copy of the scenario."""
    hands = tour.hands
    hands.open("planCollapsibleButton")
    hands.click("placeTrajectoryButton")
    line = hands.find("planComboBox").currentNode()
    for place in TRAJECTORY_MM:
        line.AddControlPoint(*place)
    interaction = slicer.app.applicationLogic().GetInteractionNode()
    interaction.SetCurrentInteractionMode(interaction.ViewTransform)
    hands.let_pass(0.5)
    hands.find("planTitleLineEdit").text = "Plan of the tour"
    hands.click("keepPlanButton")
    combo = hands.find("scenarioComboBox")
    hands.wait_until(lambda: combo.currentText == "Plan of the tour", "the copy is chosen")
    told = hands.text("scenarioText")
    tour.remove_chosen_scenario()
    return told


def replay(tour: Tour) -> str:
    hands = tour.hands
    hands.open("scoreCollapsibleButton")
    hands.click("replayButton")
    hands.wait_until(lambda: slicer.util.getNodes("Replay of *"), "the replay is there")
    hands.wait_until(lambda: hands.find("worstTouchButton").enabled, "the replay is ready")
    hands.click("worstTouchButton")
    hands.wait_until(lambda: "clearance" in hands.text("replayText"), "it is told")
    return hands.text("replayText")


def tables_and_plots(tour: Tour) -> str:
    """Show tables, learning curve and calibration; each time the user's layout comes back."""
    hands, layouts = tour.hands, []
    own = _layout()
    for name in ("showTablesButton", "learningCurveButton", "calibrationButton"):
        # The module folds a section when its step is over, and gives the layout back.
        hands.open("traineesCollapsibleButton", "historyGroupBox", "scoreCollapsibleButton")
        hands.click(name)
        hands.wait_until(lambda: _layout() != own, f"{name} shows another layout")
        layouts.append(_layout())
        hands.click(name)
        hands.wait_until(lambda: _layout() == own, f"{name} gives the layout back")
    return f"layouts {', '.join(map(str, layouts))}, then {own} again"


def _layout() -> int:
    """Return the number of the layout that is shown."""
    name = "vtkMRMLLayoutNode"
    return slicer.mrmlScene.GetSingletonNode(name, name).GetViewArrangement()


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


def zip_file(tour: Tour) -> str:
    """Save the scenario without its names, and add it again under what it is called then."""
    hands, path = tour.hands, tour.fresh("scenario.zip")
    hands.open("scenarioCollapsibleButton", "shareGroupBox")
    # Its tasks have fiducials on the face, which could not go without them.
    hands.check("removeFaceCheckBox", wanted=False)
    tour.dialogs.answer("Save the scenario", path)
    hands.click("exportScenarioButton")
    hands.wait_until(path.is_file, "the file is written", SCENARIO_TIMEOUT_S)
    hands.wait_until(lambda: "is written" in hands.text("scenarioText"), "it is told")
    told = hands.text("scenarioText")
    tour.dialogs.answer("Add a scenario", path)
    hands.click("importScenarioButton")
    hands.wait_until(lambda: "is added" in hands.text("scenarioText"), "it is added")
    tour.remove_chosen_scenario()
    return told


def preview_and_check(tour: Tour) -> str:
    """Look for the head of a volume, and have the choices checked before anything is made."""
    hands = tour.hands
    hands.open("newScenarioCollapsibleButton", "adjustHeadGroupBox", "planForScenarioGroupBox")
    _choose_volume(tour)
    hands.click("previewHeadButton")
    text = "newScenarioText"
    hands.wait_until(
        lambda: "the head that was found" in hands.text(text), "it is found", SCENARIO_TIMEOUT_S
    )
    hands.open("scenarioCollapsibleButton", "otherHeadGroupBox")
    hands.find("headModelComboBox").setCurrentNode(slicer.util.getNode("Head as found"))
    hands.click("useHeadButton")
    hands.wait_until(lambda: "is the head now" in hands.text("otherHeadText"), "it is used")
    hands.click("checkScenarioButton")
    hands.wait_until(lambda: "can be used" in hands.text(text), "it is checked", SCENARIO_TIMEOUT_S)
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
    told = hands.text("newScenarioText")
    tour.remove_chosen_scenario()
    return told


def _choose_volume(tour: Tour) -> None:
    """Choose the images of the scenario, as if they were a patient's."""
    hands = tour.hands
    (volume,) = slicer.util.getNodesByClass("vtkMRMLScalarVolumeNode")
    hands.find("scanComboBox").setCurrentNode(volume)
    hands.find("titleLineEdit").text = "Head of the tour"
    hands.let_pass(0.1)


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
    table = hands.find("stepsTable")
    hands.wait_until(lambda: table.rowCount, "the steps are listed")
    told = hands.text("stepText")
    leads = ("Answer", "Start the step", "Break")
    hands.wait_until(lambda: hands.text("nextStepButton") in leads, "the button leads on")
    _answer_questionnaire(tour)
    hands.must(table.item(0, 1).text() == "done", "The answers are not kept.")
    tour.dialogs.answer("Skip the step", "This is a tour, not a study.")
    hands.click("skipStepButton")
    hands.wait_until(lambda: "a tour" in table.item(1, 1).text(), "a step is skipped")
    return f"{told} Then: {table.item(1, 1).text()}"


def _answer_questionnaire(tour: Tour) -> None:
    """Answer the questionnaire SSQ, with which the published study begins."""
    from rastrainer.study.protocol.questionnaires import find_questionnaire

    for item in find_questionnaire("ssq").items:
        tour.hands.choose(f"{item.name}ComboBox", "1")
    tour.hands.click("saveAnswersButton")


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
    told, group = hands.text("traineeText"), _group_of_simulator(tour)
    hands.must(_processes(group), "The simulator's process is not found.")
    hands.click("stopSimulatorButton")
    hands.wait_until(lambda: hands.text("nextStepButton") == "Start and connect", "it ends")
    hands.wait_until(lambda: not _processes(group), "no process of the simulator is left")
    return told


def _group_of_simulator(tour: Tour) -> int:
    """Return the number of the process group of the simulator; on Windows, of its process."""
    from rastrainer.journal.folder_lock import read_holder

    holder = read_holder(tour.session.places.records)
    tour.hands.must(holder and holder.pid, "The simulator does not say who it is.")
    return holder.pid if os.name == "nt" else os.getpgid(holder.pid)


def _processes(group: int) -> list[str]:
    """Return a line for each process of the group that runs."""
    if os.name == "nt":
        words = ["tasklist", "/NH", "/FI", f"PID eq {group}"]
        lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout
        return [line for line in lines.splitlines() if f" {group} " in line]
    words = ["ps", "-A", "-o", "pgid=,stat=,args="]
    lines = subprocess.run(words, capture_output=True, text=True, check=True).stdout.splitlines()
    known = [line.split(None, 2) for line in lines]
    # What has ended and waits to be noticed has a Z.
    return [each[-1] for each in known if int(each[0]) == group and "Z" not in each[1]]
