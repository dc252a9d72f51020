"""Work after a trial is scored: plan, replay, tables, exports, report, scene."""

from __future__ import annotations

import slicer
from tour_stage import Tour

PLAN_MM = (10.0, 20.0, 30.0)
TRAJECTORY_MM = (39.79, 48.41, 61.59), (28.0, 30.0, 24.0)
"""Entry and target of the planned biopsy of the built-in head, which the robot can carry out."""


def plan(tour: Tour) -> str:
    hands = tour.hands
    hands.open("planCollapsibleButton")
    hands.click("placeTargetButton")
    tour.place(hands.find("planComboBox").currentNode(), PLAN_MM)
    hands.wait_enabled("sendPlanButton")
    hands.click("sendPlanButton")
    hands.wait_for("reachableText", "shows the plan")
    text, plan = hands.text("reachableText"), hands.find("planComboBox").currentNode()
    hands.click("removePlanPointButton")
    hands.must(plan.GetNumberOfControlPoints() == 0, "The target is not removed.")
    hands.click("undoPlanButton")
    hands.must(plan.GetNumberOfControlPoints() == 1, "The target is not brought back.")
    return text


def keep_trajectory(tour: Tour) -> str:
    """Place a trajectory by two points, and keep it in a copy of the scenario."""
    hands = tour.hands
    hands.open("planCollapsibleButton")
    hands.click("placeTrajectoryButton")
    tour.place(hands.find("planComboBox").currentNode(), *TRAJECTORY_MM)
    hands.find("planTitleLineEdit").text = "Plan of the tour"
    hands.click("keepPlanButton")
    combo = hands.find("scenarioComboBox")
    hands.wait_until(lambda: combo.currentText == "Plan of the tour", "the copy is chosen")
    text = hands.text("scenarioText")
    tour.remove_chosen_scenario()
    return text


def replay(tour: Tour) -> str:
    hands = tour.hands
    hands.open("scoreCollapsibleButton")
    hands.click("replayButton")
    hands.wait_until(lambda: slicer.util.getNodes("Replay of *"), "the replay is loaded")
    hands.wait_enabled("worstTouchButton")
    hands.click("worstTouchButton")
    hands.wait_for("replayText", "clearance")
    return hands.text("replayText")


def tables_and_plots(tour: Tour) -> str:
    """Show tables, learning curve and calibration; each time the user's layout is restored."""
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
    hands.idle_for(0.5)
    slicer.util.loadScene(str(path))
    hands.wait_for("linkText", "Connected")
    hands.must(slicer.util.getNodes("*fiducials"), "The fiducials are not in the scene.")
    return f"{path.stat().st_size} bytes"
