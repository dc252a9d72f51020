"""The screens of a trial, no matter who starts, pauses or ends it."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer.study_messages import StudyStep
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow import trial_screen
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.presentation.screen import ScreenMessage, Tone
from Testing.simulator.flow.trainee import STEP_S


def test_a_trial_that_slicer_starts_pauses_and_aborts_shows_the_same_screens(trainee):
    trainee.start("task-2", "T-99")
    assert trainee.presenter.screen.instruction.text == "T-99, touch point 1."
    assert trainee.presenter.screen.status[:2] == ("Task 2", "0 of 15 points")
    trainee.submit("Pause")
    trainee.until_menu("trial")
    trainee.submit("Resume")
    trainee.until_menu(None)
    trainee.submit("Abort")
    trainee.until_menu("experiment")
    assert trainee.item("trainee").value == "T-99"


def test_a_trial_is_aborted_only_after_the_trainee_confirms(trainee):
    trainee.start("task-1")
    trainee.tap_until("menu", "trial")
    trainee.choose("abort", "abort")
    assert trainee.menu.focus == "keep"
    trainee.tap_until("accept", "trial")
    assert trainee.state.training.phase == "paused"
    trainee.choose("abort", "abort")
    trainee.choose("abort", "experiment")
    assert trainee.state.training.phase == "idle"
    # A stray key after the trial does not create another trainee.
    trainee.hands.type("d")
    assert (trainee.item("trainee").value, trainee.menu.focus) == ("P07", "trial-run")


def test_tasks_wait_for_the_previous_one_unless_the_instructor_disables_that(trainee, outside):
    # Where Slicer is connected, an instructor gives each trainee an ID.
    outside.has_slicer = True
    trainee.open_experiment()
    assert trainee.item("trial-run").help == "Enter your ID first."
    trainee.presenter.on_text(1, "trainee", "P07")
    trainee.step()
    assert trainee.item("trial-run").is_enabled
    assert trainee.item("task-1").help == (
        "Trial run comes first: touch all its points, or practice until its time is over."
    )
    trainee.focus("task-3")
    trainee.tap("accept")
    trainee.step()
    assert trainee.watcher.kinds[-1] == "error"
    assert trainee.state.training.phase == "idle"
    trainee.tap_until("back", "start")
    trainee.choose("settings", "settings")
    assert not trainee.item("order").is_enabled
    assert "preferences.json" in trainee.item("order").help
    session = trainee.presenter._session
    session.prefer(order="any")
    trainee.tap_until("back", "start")
    trainee.choose("train", "experiment")
    assert trainee.item("task-5").is_enabled


def test_after_five_minutes_of_practice_the_trainee_is_asked_once(trainee, outside, monkeypatch):
    # Time continues while the start is written to disk, which may take any time.
    monkeypatch.setattr(trial_screen, "TRIAL_RUN_S", 3600.0)
    trainee.start("trial-run")
    monkeypatch.setattr(trial_screen, "TRIAL_RUN_S", trainee.state.elapsed + 3.0)
    trainee.until(lambda: trainee.presenter.screen.status[2] == "00:03 left", "the remaining time")
    trainee.until_menu("practice")
    assert trainee.state.training.phase == "paused"
    trainee.hands.key("Space")
    assert trainee.menu.focus == ""
    trainee.until(lambda: trainee.menu.focus)
    assert trainee.state.training.phase == "paused"
    assert trainee.menu.focus == "resume"
    trainee.choose("resume", None)
    trainee.step(25)
    assert trainee.menu is None
    trainee.tap_until("menu", "practice")
    trainee.choose("finish", "experiment")
    assert trainee.item("task-1").is_enabled
    scenario = trainee.loop.setup.scenario.name
    known = {("P07", scenario): {"trial-run"}}
    records = outside.services.records
    trainee.until(lambda: TraineeHistory(records).done == known, "known after a restart, too")


def test_a_menu_that_opens_by_itself_accepts_no_input_for_seven_tenths_of_a_second(trainee):
    trainee.start("task-1")
    trainee.submit("Pause")
    trainee.until_menu("trial")
    steps = 0
    while trainee.menu.focus == "":
        trainee.hands.key("Space")
        trainee.hands.key("Backspace")
        steps += 4
        assert trainee.state.training.phase == "paused"
    assert 0.6 <= steps * STEP_S <= 0.9
    trainee.hands.key("Space")
    trainee.until_menu(None)


def test_a_touch_too_far_away_is_refused_in_the_chosen_language_with_one_tone(trainee):
    trainee.choose("settings", "settings")
    trainee.focus("language")
    trainee.tap("right")
    trainee.step()
    assert trainee.menu.title == "Einstellungen"
    trainee.start("task-1")
    assert trainee.presenter.screen.instruction.text == "P07, berühre Punkt 1."
    trainee.tap("touch")
    trainee.until(lambda: trainee.presenter.screen.instruction.tone == "warning")
    assert trainee.presenter.screen.instruction.text.startswith("Zu weit von Punkt 1: ")
    trainee.step(20)
    assert trainee.watcher.kinds.count("error") == 1
    trainee.lower_onto(trainee.place("1"), trainee.place())
    trainee.until(lambda: trainee.state.touch == "on skin", "the skin")
    trainee.step(15)
    assert trainee.presenter.screen.instruction.text.startswith("Auf der Haut")


@pytest.mark.parametrize(
    ("choice", "task", "guidance"),
    [
        ("fading", "trial-run", "words"),
        ("fading", "task-3", "none"),
        ("words", "task-5", "words"),
        ("study", "task-1", "none"),
    ],
)
def test_guidance_fades_from_task_to_task_unless_setting_or_study_say_otherwise(
    trainee, outside, choice, task, guidance
):
    session = trainee.presenter._session
    if choice == "study":
        step = StudyStep("P07", "trial", task=task, guidance=guidance)
        outside.services.assigned.take_step(step)
    else:
        session.prefer(guidance=choice)
    trainee.start(task)
    screen = trainee.presenter.screen
    assert any("mm" in fact for fact in screen.status) is (guidance == "words")
    if guidance == "words":
        away = MM_PER_M * np.linalg.norm(trainee.place("1") - trainee.tip)
        words = screen.status[3].split()
        assert (words[:2], abs(float(words[2]) - away) <= 2.5) == (["Point", "1:"], True)
    assert screen.has_arrow is (guidance != "none")
    trainee.step(15)
    trainee.submit("Abort")
    trainee.close()
    trainee.loop.stop()
    (path,) = outside.services.records.glob("*.journal")
    (entry,) = read_journal(path).of_kind("guidance")
    assert entry["guidance"] == guidance


def test_the_trainee_sees_that_slicer_has_disconnected_and_who_will_score(trainee, outside):
    trainee.start("task-1")
    assert trainee.presenter.screen.warnings == ()
    outside.has_slicer = True
    trainee.step(20)
    outside.has_slicer = False
    trainee.step(20)
    assert "3D Slicer is lost" in trainee.presenter.screen.warnings[0].text
    outside.has_slicer = True
    trainee.step(20)
    assert trainee.presenter.screen.warnings == ()


def test_settings_that_would_affect_the_arm_wait_for_the_end_of_a_trial(trainee, outside):
    trainee.start("task-1")
    trainee.tap_until("menu", "trial")
    trainee.choose("settings", "settings")
    assert not trainee.item("direction").is_enabled
    assert not trainee.item("guidance").is_enabled
    assert trainee.item("volume").is_enabled
    trainee.submit("Abort")
    trainee.until_menu("experiment")
    trainee.until(lambda: trainee.menu.focus)
    trainee.tap_until("back", "start")
    trainee.choose("settings", "settings")
    trainee.focus("fine")
    trainee.tap("right", "right", "left")
    trainee.until(lambda: outside.settings, "the new simulation")
    trainee.step(150)
    assert [settings.teleoperation.fine_speed for settings in outside.settings] == [0.04]


def test_quitting_asks_for_confirmation(trainee, outside):
    trainee.choose("quit", "quit")
    trainee.tap_until("accept", "start")
    assert not outside.has_quit
    trainee.choose("quit", "quit")
    trainee.choose("leave")
    trainee.step()
    assert outside.has_quit


def test_straying_from_the_path_to_the_next_point_is_reported_and_a_correct_touch_is_not(pilot):
    pilot.start("task-1")
    center, second = pilot.place(), pilot.place("2")
    pilot.touch_point("1")
    shown = [screen for screen in pilot.watcher.screens if screen.menu is None]
    assert [screen.warnings for screen in shown if screen.warnings] == []
    on_skin = [screen.instruction for screen in shown if "skin" in screen.instruction.text]
    assert on_skin[0] == ScreenMessage("On the skin: press A.", Tone.GOOD)
    assert pilot.watcher.kinds.count("on-skin") == 1
    assert "contact" not in pilot.watcher.kinds
    pilot.touch_point("2")
    found = [screen.instruction.text for screen in pilot.watcher.screens]
    assert [text for text in found if "off the path" in text] == []
    aside = np.cross(second - center, pilot.place("3") - center)
    aside *= 0.09 / np.linalg.norm(aside)
    pilot.steer_to(1.4 * (second - center) + center, 0.02)
    pilot.steer_to(1.4 * (second - center) + center + aside, 0.02)
    pilot.hands.push(0.0, 0.0, 0.0, False)
    pilot.step(20)
    assert pilot.presenter.screen.instruction.text == "P07, you are off the path to point 3."
    pilot.steer_to(1.4 * (second - center) + center, 0.02)
    pilot.step(20)
    assert pilot.presenter.screen.instruction.text.endswith("Now touch point 3.")


def test_a_pressed_tool_is_reported_with_its_depth(pilot):
    pilot.start("task-1")
    above = pilot.place() + np.array([0.0, 0.0, 0.13])
    pilot.steer_to(above, 0.01)
    pilot.steer_to(above - (0.0, 0.0, 0.13), 0.0, fine=True, ends_in_contact=True)
    pilot.hands.push(0.0, 0.0, 0.0, False)
    pilot.step(20)
    assert pilot.submit("Jog", velocityMmS=[0, 0, -10], durationS=0.3).ok
    pilot.step(30)
    depth_mm = round(2000.0 * pilot.state.depth) / 2.0
    assert depth_mm > 1.0
    (warning,) = pilot.presenter.screen.warnings
    assert warning.text == f"Pressing {depth_mm:.1f} mm: ease off."
