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
    tour.must(tour.module._timer.isActive(), "The module's timer does not run.")
    if tour.program:
        tour.find("programPathLineEdit").currentPath = tour.program
    tour.find("windowCheckBox").checked = tour.has_window
    tour.choose_study(tour.fresh(STUDY))
    tour.wait_for("nextStepButton", "Start and connect")
    return tour.text("nextStepText")


def connect_to_web_page(tour: Tour) -> str:
    """Connect to a port that speaks HTTP, which once ended Slicer."""
    tour.open("simulatorCollapsibleButton", "advancedGroupBox")
    port = tour.find("portSpinBox")
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
        tour.click("probeButton")
        tour.wait_for("stateText", "web page")
        tour.click("connectButton")
        tour.wait_for("linkText", "No simulator")
        text = tour.text("stateText")
        tour.idle_for(3.0)
        tour.click("connectButton")
        tour.wait_for("linkText", "Not connected")
    finally:
        page.kill()
        port.value = former
    return text


def start_and_connect(tour: Tour) -> str:
    tour.dialogs.answer("not set up on this computer yet", "Ok")
    tour.click("nextStepButton")
    patience = SETUP_TIMEOUT_S if tour.session.simulator.setup.isRunning else 0.0
    tour.wait_for("linkText", "Connected", patience)
    tour.dialogs.forget()
    return tour.text("stateText")


def create_trainee(tour: Tour) -> str:
    tour.find("pseudonymLineEdit").text = TRAINEE
    tour.check("newConsentCheckBox")
    tour.click("nextStepButton")
    tour.must(TRAINEE in tour.find("traineeComboBox").currentText, "No trainee is chosen.")
    for is_active in (False, True):
        tour.click("archiveButton")
        active = [each.pseudonym for each in tour.session.trainees.trainees()]
        tour.must((TRAINEE in active) == is_active, "The archive is not followed.")
    return tour.text("traineeText")


def show_scenario(tour: Tour) -> str:
    tour.open("scenarioCollapsibleButton")
    tour.choose("taskComboBox", "Task 1")
    tour.click("showScenarioButton")
    tour.check("robotCheckBox")
    tour.wait_until(lambda: slicer.util.getNodes("Robot link 7"), "the robot is shown")
    return tour.text("scenarioText")


def abort_trial_run(tour: Tour) -> str:
    """Start the trial run, and abort it after changing one's mind once."""
    tour.open("trainingCollapsibleButton")
    # The tutorial would come first, and waits for a person.
    tour.check("tutorialCheckBox", wanted=False)
    tour.click("startTrialRunButton")
    tour.wait_for("nextStepButton", "Pause")
    tour.dialogs.answer("Abort the trial", "No")
    tour.click("abortButton")
    tour.idle_for(1.0)
    tour.must(tour.text("nextStepButton") == "Pause", "It was aborted against the answer.")
    tour.dialogs.answer("Abort the trial", "Yes")
    tour.click("abortButton")
    tour.wait_enabled("startTaskButton")
    return tour.text("phaseText")


def start_task(tour: Tour) -> str:
    tour.open("trainingCollapsibleButton")
    tour.click("startTaskButton")
    tour.wait_for("nextStepButton", "Pause")
    return tour.text("phaseText")


def touch_some(tour: Tour) -> str:
    return tour.touch(1, 7)


def pause_and_resume(tour: Tour) -> None:
    tour.click("nextStepButton")
    tour.wait_for("nextStepButton", "Resume")
    tour.click("pauseButton")
    tour.wait_for("nextStepButton", "Pause")


def close_scene_during_trial(tour: Tour) -> str:
    slicer.mrmlScene.Clear(0)
    tour.wait_for("linkText", "Connected")
    tour.wait_until(lambda: slicer.util.getNodes("*fiducials"), "the trial is shown again")
    return tour.text("phaseText")


def touch_the_others(tour: Tour) -> str:
    report = tour.touch(8, 15)
    tour.wait_until(lambda: tour.find("residualsTable").rowCount == 15, "15 pairs are registered")
    return report


def fix_registration(tour: Tour) -> str:
    tour.open("registrationCollapsibleButton", "residualsGroupBox", "pointListsGroupBox")
    text = tour.text("warning0Text")
    tour.must(f"Point {SLIP_AT}" in text, f"The slip is not found: {text}")
    tour.click("remedy0Button")
    table = tour.find("residualsTable")
    tour.wait_until(lambda: table.rowCount == 14, "the point is left out")
    tour.click("undoButton")
    tour.wait_until(lambda: table.rowCount == 15, "the point is back")
    table.selectRow(3)
    tour.click("excludeButton")
    tour.wait_until(lambda: table.rowCount == 14, "another point is left out")
    tour.click("undoButton")
    tour.wait_until(lambda: table.rowCount == 15, "the point is back, too")
    table.selectRow(3)
    tour.find("fleSpinBox").value = FLE_MM
    tour.click("fleButton")
    stated = f"{FLE_MM:.2f}"
    tour.wait_until(lambda: table.item(3, 3).text() == stated, "the point weighs less")
    tour.click("undoButton")
    tour.wait_until(lambda: table.item(3, 3).text() != stated, "the point has its weight again")
    tour.choose("kindComboBox", "Affine")
    tour.choose("kindComboBox", "Rigid")
    tour.check("headColoredCheckBox")
    tour.check("headColoredCheckBox", wanted=False)
    return text


def score(tour: Tour) -> str:
    tour.play("--register")
    tour.wait_for("nextStepButton", "Show result")
    tour.click("nextStepButton")
    tour.open("measuresGroupBox")
    tour.wait_until(lambda: tour.find("scoreTable").rowCount, "the score is shown")
    tour.wait_for("feedbackText", "Score")
    return tour.text("feedbackText").splitlines()[0]
