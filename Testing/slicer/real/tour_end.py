"""The tour's end: a study, every node deleted, the trainee deleted, and the simulator stopped."""

from __future__ import annotations

import os
import subprocess

import slicer
from tour_stage import Tour
from tour_trial import STUDY, TRAINEE


def curriculum(tour: Tour) -> str:
    """Set a curriculum for everyone in a new study, and end it."""
    tour.choose_study(tour.fresh("practiced.db"))
    hands = tour.hands
    hands.open("studyCollapsibleButton", "curriculumCollapsibleButton")
    path = tour.session.places.assets / "studies" / "example-curriculum.json"
    hands.find("curriculumPathLineEdit").currentPath = str(path)
    hands.click("createTraineeButton")
    hands.click("everybodyCheckBox")
    hands.click("setCurriculumButton")
    table = hands.find("assignmentsTable")
    hands.wait_until(lambda: table.rowCount, "the assignments are listed")
    text = hands.text("curriculumText")
    tour.dialogs.answer("End the curriculum", "Yes")
    hands.click("endCurriculumButton")
    hands.wait_until(lambda: not table.rowCount, "none is left")
    return text


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
    text = hands.text("stepText")
    leads = ("Answer", "Start the step", "Break")
    hands.wait_until(
        lambda: hands.text("nextStepButton") in leads, "the button leads to the next step"
    )
    _answer_questionnaire(tour)
    hands.must(table.item(0, 1).text() == "done", "The answers are not kept.")
    tour.dialogs.answer("Skip the step", "This is a tour, not a study.")
    hands.click("skipStepButton")
    hands.wait_until(lambda: "a tour" in table.item(1, 1).text(), "a step is skipped")
    _abort_and_repeat_step(tour)
    return f"{text} Then: {table.item(1, 1).text()}"


def _abort_and_repeat_step(tour: Tour) -> None:
    """Abort a trial of the study, say why it is repeated, and abort it again."""
    hands = tour.hands
    hands.open("trainingCollapsibleButton")
    hands.wait_enabled("startStepButton")
    # An aborted trial counts, at once, if it has a touch.
    _abort_step(tour, "--points", "1", "1")
    hands.wait_until(lambda: hands.find("repeatStepButton").visible, "a reason is asked for")
    tour.dialogs.answer("Repeat the step", "The tour has aborted it.")
    hands.click("repeatStepButton")
    hands.wait_until(lambda: hands.find("startStepButton").visible, "it can be repeated")
    _abort_step(tour)


def _abort_step(tour: Tour, *played: str) -> None:
    hands = tour.hands
    hands.click("startStepButton")
    hands.wait_for("nextStepButton", "Pause")
    if played:
        tour.play(*played)
    tour.dialogs.answer("Abort the trial", "Yes")
    hands.click("abortButton")
    hands.wait_until(lambda: hands.text("nextStepButton") != "Pause", "no trial is open")


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
            hands.idle_for(0.05)
            count += 1
    hands.wait_for("linkText", "Connected")
    return f"{count} nodes"


def delete_trainee_and_stop(tour: Tour) -> str:
    hands = tour.hands
    tour.choose_study(tour.folder / STUDY)
    hands.choose("traineeComboBox", TRAINEE)
    tour.dialogs.answer("cannot be undone", "Yes")
    hands.click("deleteTraineeButton")
    hands.wait_for("traineeText", "was deleted")
    text, group = hands.text("traineeText"), _group_of_simulator(tour)
    hands.must(_processes(group), "The simulator's process is not found.")
    hands.click("stopSimulatorButton")
    hands.wait_for("nextStepButton", "Start and connect")
    hands.wait_until(lambda: not _processes(group), "no process of the simulator is left")
    return text


def start_and_stop(tour: Tour) -> str:
    """Start the simulator by its own button, and stop it at once."""
    hands = tour.hands
    hands.open("simulatorCollapsibleButton")
    hands.click("startSimulatorButton")
    hands.wait_for("linkText", "Connected")
    text = hands.text("programText")
    hands.click("stopSimulatorButton")
    hands.wait_for("nextStepButton", "Start and connect")
    return text


def _group_of_simulator(tour: Tour) -> int:
    """Return the number of the process group of the simulator; on Windows, of its process."""
    from rastrainer.journal.folder import read_holder

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
    # A Z marks a process that has ended and is not noticed yet.
    return [each[-1] for each in known if int(each[0]) == group and "Z" not in each[1]]
