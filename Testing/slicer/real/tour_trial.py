"""The tour's first half: from an empty Slicer to the score of a trial."""

from __future__ import annotations

import subprocess

import slicer
from tour_stage import SLIP_AT, Tour

TRAINEE = "TOUR-1"
STUDY = "study.db"
FLE_MM = 20.0
SETUP_TIMEOUT_S = 1800.0
WEB_PAGE = """
import http.server, os, threading
server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), http.server.SimpleHTTPRequestHandler)
# Killing Slicer's launcher of Python does not kill Python itself: it ends by itself.
threading.Timer(60.0, os._exit, (0,)).start()
print(server.server_port, flush=True)
server.serve_forever()
"""


def open_module(tour: Tour) -> str:
    hands = tour.hands
    hands.must(hands.module._timer.isActive(), "The module's timer does not run.")
    if tour.program:
        hands.find("programPathLineEdit").currentPath = tour.program
    hands.find("windowCheckBox").checked = tour.has_window
    tour.choose_study(tour.fresh(STUDY))
    hands.wait_for("nextStepButton", "Start and connect")
    return hands.text("nextStepText")


def connect_to_web_page(tour: Tour) -> str:
    """Connect to a port that speaks HTTP, which once ended Slicer."""
    hands = tour.hands
    hands.open("simulatorCollapsibleButton", "advancedGroupBox")
    port = hands.find("portSpinBox")
    former = port.value
    page = subprocess.Popen(
        [str(tour.session.places.python), "-c", WEB_PAGE],
        cwd=tour.folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        port.value = int(page.stdout.readline())
        hands.click("probeButton")
        hands.wait_for("stateText", "web page")
        hands.click("connectButton")
        hands.wait_for("linkText", "No simulator")
        text = hands.text("stateText")
        hands.idle_for(3.0)
        hands.click("connectButton")
        hands.wait_for("linkText", "Not connected")
    finally:
        page.kill()
        port.value = former
    return text


def start_and_connect(tour: Tour) -> str:
    hands = tour.hands
    tour.dialogs.answer("not set up on this computer yet", "Ok")
    hands.click("nextStepButton")
    patience = SETUP_TIMEOUT_S if tour.session.simulator.setup.isRunning else 0.0
    hands.wait_for("linkText", "Connected", patience)
    tour.dialogs.forget()
    return hands.text("stateText")


def create_trainee(tour: Tour) -> str:
    hands = tour.hands
    hands.find("pseudonymLineEdit").text = TRAINEE
    hands.check("newConsentCheckBox")
    hands.click("nextStepButton")
    hands.must(TRAINEE in hands.find("traineeComboBox").currentText, "No trainee is chosen.")
    for is_active in (False, True):
        hands.click("archiveButton")
        active = [each.pseudonym for each in tour.session.trainees.trainees()]
        hands.must((TRAINEE in active) == is_active, "The archive is not followed.")
    return hands.text("traineeText")


def show_scenario(tour: Tour) -> str:
    hands = tour.hands
    hands.open("scenarioCollapsibleButton")
    hands.choose("taskComboBox", "Task 1")
    hands.click("showScenarioButton")
    hands.check("robotCheckBox")
    hands.wait_until(lambda: slicer.util.getNodes("Robot link 7"), "the robot is shown")
    return hands.text("scenarioText")


def abort_trial_run(tour: Tour) -> str:
    """Start the trial run, and abort it after changing one's mind once."""
    hands = tour.hands
    hands.open("trainingCollapsibleButton")
    # The tutorial would come first, and waits for a person.
    hands.check("tutorialCheckBox", wanted=False)
    hands.click("startTrialRunButton")
    hands.wait_for("nextStepButton", "Pause")
    tour.dialogs.answer("Abort the trial", "No")
    hands.click("abortButton")
    hands.idle_for(1.0)
    hands.must(hands.text("nextStepButton") == "Pause", "It was aborted against the answer.")
    tour.dialogs.answer("Abort the trial", "Yes")
    hands.click("abortButton")
    hands.wait_enabled("startTaskButton")
    return hands.text("phaseText")


def start_task(tour: Tour) -> str:
    hands = tour.hands
    hands.open("trainingCollapsibleButton")
    hands.click("startTaskButton")
    hands.wait_for("nextStepButton", "Pause")
    return hands.text("phaseText")


def touch_some(tour: Tour) -> str:
    return tour.touch(1, 7)


def pause_and_resume(tour: Tour) -> None:
    hands = tour.hands
    hands.click("nextStepButton")
    hands.wait_for("nextStepButton", "Resume")
    hands.click("pauseButton")
    hands.wait_for("nextStepButton", "Pause")


def close_scene_during_trial(tour: Tour) -> str:
    hands = tour.hands
    slicer.mrmlScene.Clear(0)
    hands.wait_for("linkText", "Connected")
    hands.wait_until(lambda: slicer.util.getNodes("*fiducials"), "the trial is shown again")
    return hands.text("phaseText")


def touch_the_others(tour: Tour) -> str:
    report = tour.touch(8, 15)
    tour.hands.wait_until(
        lambda: tour.hands.find("residualsTable").rowCount == 15, "15 pairs are registered"
    )
    return report


def fix_registration(tour: Tour) -> str:
    hands = tour.hands
    hands.open("registrationCollapsibleButton", "residualsGroupBox", "pointListsGroupBox")
    text = hands.text("warning0Text")
    hands.must(f"Point {SLIP_AT}" in text, f"The slip is not found: {text}")
    hands.click("remedy0Button")
    table = hands.find("residualsTable")
    hands.wait_until(lambda: table.rowCount == 14, "the point is left out")
    hands.click("undoButton")
    hands.wait_until(lambda: table.rowCount == 15, "the point is back")
    table.selectRow(3)
    hands.click("excludeButton")
    hands.wait_until(lambda: table.rowCount == 14, "another point is left out")
    hands.click("undoButton")
    hands.wait_until(lambda: table.rowCount == 15, "the point is back, too")
    table.selectRow(3)
    hands.find("fleSpinBox").value = FLE_MM
    hands.click("fleButton")
    stated = f"{FLE_MM:.2f}"
    hands.wait_until(lambda: table.item(3, 3).text() == stated, "the point weighs less")
    hands.click("undoButton")
    hands.wait_until(lambda: table.item(3, 3).text() != stated, "the point has its weight again")
    hands.choose("kindComboBox", "Affine")
    hands.choose("kindComboBox", "Rigid")
    hands.check("headColoredCheckBox")
    hands.check("headColoredCheckBox", wanted=False)
    return text


def score(tour: Tour) -> str:
    hands = tour.hands
    tour.play("--register")
    hands.wait_for("nextStepButton", "Show result")
    hands.click("nextStepButton")
    hands.open("measuresGroupBox")
    hands.wait_until(lambda: hands.find("scoreTable").rowCount, "the score is shown")
    hands.wait_for("feedbackText", "Score")
    return hands.text("feedbackText").splitlines()[0]
