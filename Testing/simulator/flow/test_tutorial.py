"""The tutorial in the flow: by keyboard and gamepad; its gates, its file and its end."""

from __future__ import annotations

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer.json_records import record_to_json
from rastrainer.study_messages import StudyStep
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.session.session import TUTORIAL_VIEW
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.flow.session.tutorial import TutorialStep
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.record.trial_context import TutorialOutcome
from Testing.simulator.flow.trainee import FlowLearner
from Testing.tutorial_player import TutorialPlayer

FIRST = "The tutorial comes first, with the device that you use now: it takes two minutes."
STUDY_RUN = StudyStep("P07", "trial-run", 2, 9, "trial-run", "desktop", minutes=8.0)
LEARNED = TutorialOutcome(
    trainee="P07",
    device="keyboard",
    mode="desktop",
    duration_s=112.0,
    first_error_mm=2.3,
    errors_mm=(1.2, 0.8, 0.6),
)


def session_of(trainee):
    return trainee.presenter._session


def go_to_experiment(trainee, rule="required"):
    """Go from the start menu to the experiment menu, as P07."""
    session = session_of(trainee)
    session.prefer(tutorial=rule)
    session.trainee = "P07"
    trainee.open_experiment()


@pytest.fixture
def menu(trainee):
    """The trainee at the experiment menu, where the tutorial is required."""
    go_to_experiment(trainee)
    return trainee


@pytest.fixture
def learner(menu):
    """The trainee at the first step of the tutorial."""
    menu.choose("tutorial", None)
    menu.until(lambda: status(menu)[1:2] == ("Step 1 of 14",), "the first step")
    return menu


def status(trainee):
    return trainee.presenter.screen.status


def instruction(trainee):
    return trainee.presenter.screen.instruction.text


def go_to_step(trainee, step):
    """Have the steps before one counted as done."""
    tutorial = session_of(trainee).tutorial
    tutorial._done = list(tutorial.steps[: tutorial.steps.index(step)])
    trainee.step(15)


@pytest.mark.parametrize(
    ("who", "device", "says"),
    [
        ("trainee", SourceKind.KEYBOARD, ("30 mm to the right: D.", "the view by 20°: Q / E, or")),
        pytest.param(
            "pilot",
            SourceKind.GAMEPAD,
            ("the right: Left stick right.", "20°: D-pad left / right."),
            marks=pytest.mark.soak,
        ),
    ],
)
def test_the_tutorial_is_played_and_leads_to_the_trial_run(who, device, says, request, outside):
    trainee = request.getfixturevalue(who)
    go_to_experiment(trainee)
    assert (trainee.menu.focus, trainee.item("trial-run").help) == ("tutorial", FIRST)
    assert not trainee.item("trial-run").is_enabled
    trainee.choose("tutorial", None)
    phases = set()
    stop = trainee.loop.subscribe(lambda result: phases.add(result.state.training.phase.value))
    player = TutorialPlayer(FlowLearner(trainee), device)
    player.play()
    stop()
    assert phases == {"idle"}, "the simulation knows of no trial"
    assert list(outside.services.records.glob("*.journal")) == []
    read = dict(player.read)
    assert says[0] in read[TutorialStep.RIGHT]
    assert says[1] in read[TutorialStep.TURN_VIEW]
    assert trainee.menu.name == "tutorial-done"
    finished = TraineeHistory(outside.services.records).learned.get("P07")
    assert (finished.device, finished.mode, finished.trainee) == (device.value, "desktop", "P07")
    assert 5.0 < finished.duration_s < 60.0
    assert set(finished.step_times_s) == {step.value for step, _ in player.read}
    assert max(finished.first_error_mm, *finished.errors_mm) < 3.0
    facts = {fact.label: fact.value for fact in trainee.menu.facts}
    shown = [
        float(each.removesuffix(" mm")) for each in facts["Errors of the last three"].split(", ")
    ]
    # Both are rounded, the file's to more digits.
    np.testing.assert_allclose(shown, finished.errors_mm, atol=0.055)
    trainee.choose("trial-run", None)
    assert trainee.state.training.task == "trial-run"
    trainee.submit("Abort")
    trainee.until_menu("experiment")
    assert trainee.item("tutorial").value == "done"
    trainee.close()
    trainee.loop.stop()
    (path,) = outside.services.records.glob("*.journal")
    (noted,) = read_journal(path).of_kind("tutorial")
    assert (noted["device"], noted["errorsMm"]) == (device.value, list(finished.errors_mm))


def test_a_step_counts_only_the_movement_it_asks_for(learner):
    learner.hands.push(-1.0, 0.0, 1.0, False)
    learner.step(20)
    learner.hands.push(0.0, 0.0, 0.0, False)
    learner.step(10)
    assert status(learner)[1:] == ("Step 1 of 14", "0 of 30 mm")
    learner.hands.push(1.0, 0.0, 0.0, True)
    learner.until(lambda: status(learner)[2:] == ("15 of 30 mm",), "half of the distance")
    learner.until(lambda: instruction(learner) == "Well done.", "the praise")
    assert learner.watcher.kinds[-1] == "step"
    learner.hands.push(0.0, 0.0, 0.0, False)
    learner.until(lambda: "left: A" in instruction(learner), "the next step")


def test_controls_not_yet_taught_do_nothing(learner):
    learner.tap("touch", "undo", "best_view")
    learner.step(50)
    assert status(learner)[1] == "Step 1 of 14"
    assert learner.presenter.shown.latest.training.next_point is None
    assert session_of(learner).view.control.orbit == TUTORIAL_VIEW
    assert "error" not in learner.watcher.kinds


def move_over_skin(learner, aside_m):
    """Bring the tip onto the skin so far from the next point."""
    point, center = FlowLearner(learner)._next()
    outward = (point - center) / np.linalg.norm(point - center)
    aside = np.cross(outward, (1.0, 0.0, 0.0))
    place = point + aside_m * aside / np.linalg.norm(aside)
    # The head is not a ball: next to the point, the skin is a little lower or higher.
    for height, speed in ((0.03, 200), (-0.0005 - 0.2 * aside_m, 40)):
        goal_mm = (MM_PER_M * (place + height * outward)).tolist()
        learner.submit("MoveTipTo", positionMm=goal_mm, speedMmS=speed)
        learner.until(lambda: learner.state.motion == "none", "the tip's rest")
    learner.step(20)


def test_a_tip_beside_the_center_is_not_praised_but_led_there(learner):
    go_to_step(learner, TutorialStep.LOWER)
    move_over_skin(learner, 0.005)
    assert learner.presenter.shown.latest.touch == "near"
    assert status(learner)[1] == "Step 10 of 14"
    assert re.match(r"On the skin, [456] mm from point 1: ", instruction(learner))
    assert session_of(learner).view.control.orbit == TUTORIAL_VIEW
    learner.tap("touch")
    learner.until(lambda: "Too far from point 1" in instruction(learner), "the refusal")
    move_over_skin(learner, 0.0)
    assert status(learner)[-1] == "Point 1: less than 2 mm away"
    learner.until(lambda: status(learner)[1] == "Step 11 of 14", "the praise")


def test_a_guided_touch_shows_its_error_on_the_head(learner):
    player = FlowLearner(learner)
    go_to_step(learner, TutorialStep.GUIDED)
    player.touch_next()
    learner.until(lambda: "mm off. Now touch point 3." in instruction(learner), "its error")
    (arrow,) = learner.presenter.screen.errors
    error_mm = MM_PER_M * np.linalg.norm(np.subtract(arrow.end, arrow.begin)) / 5.0
    assert f"Point 2: {error_mm:.1f} mm off" in instruction(learner)
    learner.tap("undo")
    learner.until(lambda: learner.presenter.screen.errors == (), "the undo")
    assert learner.watcher.kinds[-1] == "undo"


def test_the_tutorials_menu_lets_it_wait_restart_or_be_left(learner):
    go_to_step(learner, TutorialStep.UP)
    learner.tap_until("menu", "tutorial")
    assert learner.menu.paragraphs == ("The tutorial is paused at step 5 of 14.",)
    assert learner.item("leave").label == "Skip the tutorial"
    learner.tap_until("pause", None)
    assert status(learner)[1] == "Step 5 of 14"
    learner.tap_until("pause", "tutorial")
    learner.choose("restart", None)
    learner.until(lambda: status(learner)[1:2] == ("Step 1 of 14",), "the first step")
    learner.tap_until("menu", "tutorial")
    learner.choose("leave", "experiment")
    assert learner.item("trial-run").is_enabled
    assert session_of(learner).tutorial is None


def test_setting_and_study_decide_whether_the_tutorial_is_required(menu, outside):
    session = session_of(menu)

    def offered(step=None):
        if step:
            outside.services.assigned.take_step(step)
        menu.step(20)
        items = {item.name: item.is_enabled for item in menu.menu.items}
        return items.get("tutorial"), items["trial-run"]

    assert offered() == (True, False)
    session.prefer(tutorial="optional")
    assert offered() == (True, True)
    session.prefer(tutorial="skipped")
    assert offered() == (None, True)
    assert offered(replace(STUDY_RUN, tutorial="required")) == (True, False)
    session.prefer(tutorial="required")
    assert offered(replace(STUDY_RUN, tutorial="skipped")) == (None, True)
    assert offered(STUDY_RUN) == (True, False)
    session.history.note_tutorial(LEARNED)
    assert offered() == (False, True)
    assert offered(StudyStep("P07", "trial", 3, 9, "task-2", "desktop")) == (False, False)


def test_slicer_opens_the_tutorial_before_the_trial_run(trainee):
    session = session_of(trainee)
    presenter = trainee.presenter
    assert presenter.start_tutorial("P07", "desktop").data == {"isNeeded": False}
    session.prefer(tutorial="required")
    assert presenter.start_tutorial("P07", "desktop").data == {"isNeeded": True}
    trainee.until_menu(None)
    assert status(trainee)[0] == "Tutorial"
    assert presenter.start_tutorial("P07", "desktop").data == {"isNeeded": True}
    other = presenter.start_tutorial("P08", "desktop")
    assert (other.ok, other.message[:3]) == (False, "P07")
    session.end_tutorial()
    session.history.note_tutorial(LEARNED)
    assert presenter.start_tutorial("P07", "desktop").data == {"isNeeded": False}
    trainee.start("task-1")
    trainee.until(lambda: instruction(trainee) == "P07, touch point 1.", "the trial")
    refused = presenter.start_tutorial("P08", "desktop")
    assert "P07 is still doing Task 1" in refused.message


def test_the_tutorial_pauses_while_nobody_sees_it(learner):
    learner.presenter.on_visibility(1, False)
    learner.until_menu("tutorial")
    assert learner.presenter.screen.warnings[0].text == "Paused: the trial was out of sight."
    learner.choose("resume", None)
    learner.step(20)
    assert learner.presenter.screen.warnings == ()


def test_a_finished_tutorial_is_remembered_per_device_and_other_files_count_for_nothing(tmp_path):
    records = tmp_path / "records"
    tutorials = TraineeHistory(records)
    tutorials.keep_tutorial(LEARNED)
    tutorials.keep_tutorial(replace(LEARNED, trainee="P08", device="gamepad"))
    values = {"utc": "now", **record_to_json(replace(LEARNED, trainee="P09"))}
    (records / "1.tutorial").write_text(json.dumps({**values, "formatVersion": 9}))
    (records / "2.tutorial").write_text("[")
    (records / "3.tutorial").mkdir()
    again = TraineeHistory(records)
    assert again.learned.get("P07") == LEARNED
    known = [
        (name, device.value)
        for name in ("P07", "P08", "P09")
        for device in SourceKind
        if again.has_learned(name, device)
    ]
    assert known == [("P07", "keyboard"), ("P08", "gamepad"), ("P08", "keyboard")]


def test_a_tutorial_that_cannot_be_saved_counts_until_the_simulator_ends(learner, outside):
    outside.services.records.write_text("in the way")
    session = session_of(learner)
    session.tutorial._done = list(session.tutorial.steps)
    learner.until_menu("tutorial-done")
    assert "cannot be made" in learner.presenter.screen.warnings[0].text
    assert learner.item("trial-run").is_enabled


def test_switching_to_another_head_ends_the_tutorial(learner, setup):
    session_of(learner).tutorial.setup = replace(setup)
    learner.until_menu("start")
    assert [each.text for each in learner.presenter.screen.warnings] == [
        "The tutorial has ended: another head is in use."
    ]
