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
    tour.open("studyCollapsibleButton", "curriculumCollapsibleButton")
    path = tour.session.places.assets / "studies" / "example-curriculum.json"
    tour.find("curriculumPathLineEdit").currentPath = str(path)
    tour.click("createTraineeButton")
    tour.click("everybodyCheckBox")
    tour.click("setCurriculumButton")
    table = tour.find("assignmentsTable")
    tour.wait_until(lambda: table.rowCount, "the assignments are listed")
    text = tour.text("curriculumText")
    tour.dialogs.answer("End the curriculum", "Yes")
    tour.click("endCurriculumButton")
    tour.wait_until(lambda: not table.rowCount, "none is left")
    return text


def study(tour: Tour) -> str:
    tour.choose_study(tour.fresh("led.db"))
    tour.open("studyCollapsibleButton")
    protocol = tour.session.places.assets / "studies" / "published-protocol.json"
    tour.find("protocolPathLineEdit").currentPath = str(protocol)
    tour.dialogs.answer("Begin the study", "Yes")
    tour.click("beginStudyButton")
    tour.click("createTraineeButton")
    tour.click("enrollButton")
    table = tour.find("stepsTable")
    tour.wait_until(lambda: table.rowCount, "the steps are listed")
    text = tour.text("stepText")
    leads = ("Answer", "Start the step", "Break")
    tour.wait_until(
        lambda: tour.text("nextStepButton") in leads, "the button leads to the next step"
    )
    _answer_questionnaire(tour)
    tour.must(table.item(0, 1).text() == "done", "The answers are not kept.")
    tour.dialogs.answer("Skip the step", "This is a tour, not a study.")
    tour.click("skipStepButton")
    tour.wait_until(lambda: "a tour" in table.item(1, 1).text(), "a step is skipped")
    _abort_and_repeat_step(tour)
    return f"{text} Then: {table.item(1, 1).text()}"


def _abort_and_repeat_step(tour: Tour) -> None:
    """Abort a trial of the study, say why it is repeated, and abort it again."""
    tour.open("trainingCollapsibleButton")
    tour.wait_enabled("startStepButton")
    # An aborted trial counts, at once, if it has a touch.
    _abort_step(tour, "--points", "1", "1")
    tour.wait_until(lambda: tour.find("repeatStepButton").visible, "a reason is asked for")
    tour.dialogs.answer("Repeat the step", "The tour has aborted it.")
    tour.click("repeatStepButton")
    tour.wait_until(lambda: tour.find("startStepButton").visible, "it can be repeated")
    _abort_step(tour)


def _abort_step(tour: Tour, *played: str) -> None:
    tour.click("startStepButton")
    tour.wait_for("nextStepButton", "Pause")
    if played:
        tour.play(*played)
    tour.dialogs.answer("Abort the trial", "Yes")
    tour.click("abortButton")
    tour.wait_until(lambda: tour.text("nextStepButton") != "Pause", "no trial is open")


def _answer_questionnaire(tour: Tour) -> None:
    """Answer the questionnaire SSQ, with which the published study begins."""
    from rastrainer.study.protocol.questionnaires import find_questionnaire

    for item in find_questionnaire("ssq").items:
        tour.choose(f"{item.name}ComboBox", "1")
    tour.click("saveAnswersButton")


def delete_every_node(tour: Tour) -> str:
    count = 0
    for node_id in [node.GetID() for node in slicer.util.getNodesByClass("vtkMRMLNode")]:
        node = slicer.mrmlScene.GetNodeByID(node_id)
        if node is not None and not node.GetSingletonTag():
            slicer.mrmlScene.RemoveNode(node)
            tour.idle_for(0.05)
            count += 1
    tour.wait_for("linkText", "Connected")
    return f"{count} nodes"


def delete_trainee_and_stop(tour: Tour) -> str:
    tour.choose_study(tour.folder / STUDY)
    tour.choose("traineeComboBox", TRAINEE)
    tour.dialogs.answer("cannot be undone", "Yes")
    tour.click("deleteTraineeButton")
    tour.wait_for("traineeText", "was deleted")
    text, group = tour.text("traineeText"), _group_of_simulator(tour)
    tour.must(_processes(group), "The simulator's process is not found.")
    tour.click("stopSimulatorButton")
    tour.wait_for("nextStepButton", "Start and connect")
    tour.wait_until(lambda: not _processes(group), "no process of the simulator is left")
    return text


def start_and_stop(tour: Tour) -> str:
    """Start the simulator by its own button, and stop it at once."""
    tour.open("simulatorCollapsibleButton")
    tour.click("startSimulatorButton")
    tour.wait_for("linkText", "Connected")
    text = tour.text("programText")
    tour.click("stopSimulatorButton")
    tour.wait_for("nextStepButton", "Start and connect")
    return text


def _group_of_simulator(tour: Tour) -> int:
    """Return the number of the process group of the simulator; on Windows, of its process."""
    from rastrainer.journal.folder import read_holder

    holder = read_holder(tour.session.places.records)
    tour.must(holder and holder.pid, "The simulator does not say who it is.")
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
