"""Work after a trial is scored: plan, replay, tables, exports, report, scene."""

from __future__ import annotations

import slicer
from tour_stage import Tour

PLAN_MM = (10.0, 20.0, 30.0)
TRAJECTORY_MM = (39.79, 48.41, 61.59), (28.0, 30.0, 24.0)
"""Entry and target of the planned biopsy of the built-in head, which the robot can carry out."""


def plan(tour: Tour) -> str:
    tour.open("planCollapsibleButton")
    tour.click("placeTargetButton")
    tour.place(tour.find("planComboBox").currentNode(), PLAN_MM)
    tour.wait_enabled("sendPlanButton")
    tour.click("sendPlanButton")
    tour.wait_for("reachableText", "shows the plan")
    text, plan = tour.text("reachableText"), tour.find("planComboBox").currentNode()
    tour.click("removePlanPointButton")
    tour.must(plan.GetNumberOfControlPoints() == 0, "The target is not removed.")
    tour.click("undoPlanButton")
    tour.must(plan.GetNumberOfControlPoints() == 1, "The target is not brought back.")
    return text


def keep_trajectory(tour: Tour) -> str:
    """Place a trajectory by two points, and keep it in a copy of the scenario."""
    tour.open("planCollapsibleButton")
    tour.click("placeTrajectoryButton")
    tour.place(tour.find("planComboBox").currentNode(), *TRAJECTORY_MM)
    tour.find("planTitleLineEdit").text = "Plan of the tour"
    tour.click("keepPlanButton")
    combo = tour.find("scenarioComboBox")
    tour.wait_until(lambda: combo.currentText == "Plan of the tour", "the copy is chosen")
    text = tour.text("scenarioText")
    tour.remove_chosen_scenario()
    return text


def replay(tour: Tour) -> str:
    tour.open("scoreCollapsibleButton")
    tour.click("replayButton")
    tour.wait_until(lambda: slicer.util.getNodes("Replay of *"), "the replay is loaded")
    tour.wait_enabled("worstTouchButton")
    tour.click("worstTouchButton")
    tour.wait_for("replayText", "clearance")
    return tour.text("replayText")


def tables_and_plots(tour: Tour) -> str:
    """Show tables, learning curve and calibration; each time the user's layout is restored."""
    layouts = []
    own = _layout()
    for name in ("showTablesButton", "learningCurveButton", "calibrationButton"):
        # The module folds a section when its step is over, and gives the layout back.
        tour.open("traineesCollapsibleButton", "historyGroupBox", "scoreCollapsibleButton")
        tour.click(name)
        tour.wait_until(lambda: _layout() != own, f"{name} shows another layout")
        layouts.append(_layout())
        tour.click(name)
        tour.wait_until(lambda: _layout() == own, f"{name} gives the layout back")
    return f"layouts {', '.join(map(str, layouts))}, then {own} again"


def _layout() -> int:
    """Return the number of the layout that is shown."""
    name = "vtkMRMLLayoutNode"
    return slicer.mrmlScene.GetSingletonNode(name, name).GetViewArrangement()


def export(tour: Tour) -> str:
    sizes = []
    tour.open("traineesCollapsibleButton", "historyGroupBox", "scoreCollapsibleButton")
    for button, caption, name in (
        ("exportTraineeButton", "Export the trainee", "trainee.json"),
        ("exportHistoryButton", "Export the history", "history.csv"),
        ("exportScoresButton", "Export all trials", "trials.csv"),
    ):
        path = tour.fresh(name)
        tour.dialogs.answer(caption, path)
        tour.click(button)
        tour.wait_until(path.is_file, f"{name} is written")
        sizes.append(f"{name}: {path.stat().st_size} bytes")
    return ", ".join(sizes)


def report(tour: Tour) -> str:
    folder = tour.folder / "report"
    folder.mkdir(exist_ok=True)
    tour.dialogs.answer("Folder for the report", folder)
    tour.click("reportButton")
    tour.wait_until((folder / "report.html").is_file, "the report is written")
    return tour.text("scoreMessageText")


def save_and_load_scene(tour: Tour) -> str:
    path = tour.fresh("scene.mrb")
    tour.must(slicer.util.saveScene(str(path)), "The scene is not saved.")
    slicer.mrmlScene.Clear(0)
    tour.idle_for(0.5)
    slicer.util.loadScene(str(path))
    tour.wait_for("linkText", "Connected")
    tour.must(slicer.util.getNodes("*fiducials"), "The fiducials are not in the scene.")
    return f"{path.stat().st_size} bytes"
