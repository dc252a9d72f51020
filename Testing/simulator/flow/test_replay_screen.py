"""The trial that was just registered, shown again from the page of its result."""

from __future__ import annotations

import pytest

from rastrainer.protocol import FREE
from rastrainer.study_messages import StudyStep
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.flow.pages.result import ResultPage
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.messages import Hello, InstructorOrder
from Testing.simulator.flow.conftest import Outside
from Testing.simulator.flow.test_whole_flow import REGISTRATION, SCORE
from Testing.simulator.flow.trainee import Keys, Trainee

WAYS = ((1, 0, 0), (0, 1, 0), (0, 0, 1), (-1, 0, 0), (0, -1, 0))
"""The tip has to be at another position at each touch; which one does not matter here."""
PAGE = 2
W3C_B, W3C_LEFT, W3C_RIGHT = 1, 14, 15


class Place(Trainee):
    """A trainee with a keyboard, who plays trials in which every touch counts.

    Attributes:
        outside: what the presenter knows of the process around it.
        shown: the states that the views received.
    """

    # The loop's usual rate gives a replay enough samples.
    step_s, ticks_a_step = 0.008, 2

    def __init__(self, loop, presenter, outside):
        self.outside, self.shown = outside, []
        presenter.shown.subscribe(lambda result: self.shown.append(result.state))
        super().__init__(loop, presenter, Keys)

    @property
    def journal(self):
        records = self.outside.services.records
        (path,) = records.glob(f"*_{self.state.training.trial_id}.journal")
        return path

    @property
    def replay(self):
        return self.presenter.shown.latest

    @property
    def seconds(self):
        """Where in the trial it is, as the trainee reads it."""
        minutes, seconds = self.presenter.screen.status[0].split(" / ")[0].split(":")
        return 60 * int(minutes) + int(seconds)

    def play_and_be_scored(self, score=SCORE):
        self.start("task-1")
        for number in range(15):
            self.hands.push(*WAYS[number % len(WAYS)], False)
            self.step(60)
            self.hands.push(0, 0, 0, False)
            self.step(5)
            self.tap("touch")
            self.until(lambda kept=number: len(self.state.training.touches) > kept, "a touch")
        self.submit("Register")
        self.until_menu("waiting")
        trial_id = self.state.training.trial_id
        assert self.submit("SubmitRegistration", trialId=trial_id, **REGISTRATION).ok
        assert self.submit("TrialScored", trialId=trial_id, **score).ok
        self.until_menu("result")

    def open_anew(self):
        """Open the page of the result, which loads the trial when it is first asked for."""
        session = self.presenter._session
        session.pages.show(ResultPage(session))
        self.step()

    def show_again(self, item="replay"):
        self.choose(item, None)


@pytest.fixture(scope="module")
def place(anywhere, tmp_path_factory):
    """A simulator at which a trial has been scored."""
    outside = Outside(tmp_path_factory.mktemp("replay"))
    records = outside.services.records
    with ControlLoop(Simulation(anywhere, 3), records, speed=None) as loop:
        presenter = outside.presenter(loop, view="never")
        place = Place(loop, presenter, outside)
        place.until_menu("start")
        place.play_and_be_scored()
        yield place
        place.close()
        presenter.close()


@pytest.fixture
def result(place):
    """The simulator at the page of the result, before and after."""
    assert place.menu.name == "result"
    yield place
    if place.menu is None:
        place.tap_until("back", "result")


def test_the_trial_is_replayed_in_the_views_while_the_arm_stands_still(result):
    arm, before = result.state.q, result.journal.read_bytes()
    result.show_again()
    result.shown.clear()
    heard = len(result.watcher.kinds)
    result.until(lambda: len(result.replay.training.touches) == 3, "the third touch")
    assert result.watcher.kinds[heard:].count("touch") == 3
    assert result.presenter.screen.instruction.text == "Replay: Task 1 of P07"
    tips = {tuple(state.tool_tip_to_world[:3, 3]) for state in result.shown}
    assert len(tips) > 50
    assert {state.training.phase for state in result.shown} == {"running"}
    assert (result.state.q, result.state.training.phase) == (arm, "scored")
    result.tap_until("back", "result")
    assert result.replay is result.loop.latest
    assert result.journal.read_bytes() == before


def test_the_worst_touch_is_shown_at_half_speed_up_to_the_touch(result):
    result.show_again("worst")
    words = result.presenter.screen.instruction.text.split()
    assert (words[0], words[2:]) == ("Point", ["the", "worst", "touch,", "at", "half", "speed"])
    before = result.replay.sim_time
    result.step(50)
    frame_s = 1.0 / 60.0
    assert result.replay.sim_time - before == pytest.approx(25 * result.step_s, abs=frame_s)
    result.until(lambda: "Paused" in result.presenter.screen.status, "the end")
    assert result.replay.training.touches[-1].label == words[1].strip(",")


def test_the_keys_of_the_replay_command_play_and_seek(result):
    result.show_again()
    result.hands.key("ArrowRight")
    result.step(20)
    assert result.seconds == 5
    result.hands.key("ArrowLeft")
    result.step(20)
    assert result.seconds == 0
    result.hands.key("Space")
    stands = result.replay.tick
    result.step(50)
    assert result.replay.tick == stands
    assert "Paused" in result.presenter.screen.status
    camera = result.replay.camera
    result.hands.key("KeyC")
    assert {camera, result.replay.camera} == {"close-up", "far"}
    result.hands.key("KeyT")
    result.step(20)
    assert "the worst touch" in result.presenter.screen.instruction.text
    result.hands.key("KeyM")
    result.until_menu("result")


def test_a_teacher_starts_and_pauses_a_replay(result):
    presenter = result.presenter
    assert presenter.instruct(InstructorOrder.REPLAY, "") == ""
    result.until(lambda: result.replay is not result.loop.latest, "the replay")
    assert presenter.instruct(InstructorOrder.REPLAY, "") == ""
    assert presenter.instruct(InstructorOrder.PAUSE, "") == ""
    stands = result.replay.tick
    result.step(50)
    assert result.replay.tick == stands


def test_a_headset_steps_through_a_replay_by_stick_and_leaves_with_the_back_button(result):
    presenter = result.presenter
    presenter.view_left(1)
    presenter.view_joined(PAGE, Hello("headset"))
    presenter.on_item(PAGE, "replay")
    result.until_menu(None)
    assert presenter.screen.sticks_navigate
    for control, seconds in (("right", 5), ("left", 0)):
        presenter.on_press(PAGE, control)
        result.step(20)
        assert result.seconds == seconds
    presenter.on_press(PAGE, "up")
    result.step(20)
    assert "the worst touch" in presenter.screen.instruction.text
    assert ("Stick up", "Worst touch") in [(h.control, h.action) for h in presenter.screen.hints]
    presenter.on_visibility(PAGE, False)
    result.step(20)
    assert "Paused" in presenter.screen.status
    presenter.on_press(PAGE, "undo")
    result.until_menu("result")
    presenter.view_left(PAGE)
    presenter.view_joined(1, Hello("desktop"))


def test_the_view_of_the_errors_is_turned_by_the_sticks_directions(result):
    control = result.presenter._session.view.control
    control.reset()
    result.choose("errors")
    result.until(lambda: result.presenter.screen.errors, "the arrows")
    result.tap("right", "right", "up")
    assert (control.orbit.azimuth_deg, control.orbit.elevation_deg) == (20.0, 10.0)
    result.tap_until("back", "result")
    control.reset()


def test_a_gamepad_at_a_browser_seeks_through_a_replay_and_leaves_it(result):
    result.show_again()
    for button, seconds in ((W3C_RIGHT, 5), (W3C_LEFT, 0), (W3C_B, None)):
        for value in (1.0, 0.0):
            buttons = [value * (number == button) for number in range(17)]
            result.presenter.receive(1, "pad", [0.0] * 4, buttons)
            result.step(20)
        assert seconds is None or result.seconds == seconds
    result.until_menu("result")


def test_the_result_says_what_a_study_asks_for_next_and_offers_nothing_else(result):
    study = result.outside.services.assigned
    study.take_step(StudyStep("P07", "break", 4, 9, minutes=5.0))
    result.step(20)
    paragraph = result.menu.paragraphs[-1]
    assert paragraph.startswith("Step 4 of 9: take a break of at least 5 minutes, 0")
    names = [item.name for item in result.menu.items]
    assert names == ["errors", "worst", "replay", "menu"]
    study.take_step(StudyStep("P07", "trial", 5, 9, "task-2", "desktop"))
    result.step(20)
    assert result.menu.paragraphs[-1] == "Step 5 of 9: play Task 2 on the desktop screen."
    assert result.menu.items[0].label == "Next: Task 2"
    study.take_step(StudyStep("P07", FREE))
    result.step(20)
    assert not any(paragraph.startswith("Step") for paragraph in result.menu.paragraphs)


def test_a_trial_whose_journal_is_gone_is_reported_in_one_sentence(result):
    journal = result.journal
    gone = journal.rename(result.outside.services.config.with_name("elsewhere"))
    result.open_anew()
    result.choose("replay")
    result.step(20)
    assert result.menu.name == "result"
    warning = result.presenter.screen.warnings[-1].text
    assert "its journal is no longer in the records folder" in warning
    gone.rename(journal)


def test_a_trial_started_by_slicer_ends_the_replay_and_is_what_the_views_show(place):
    place.show_again()
    before = place.state.training.trial_id
    assert place.submit("StartTask", task="task-2", trainee="T-99").ok
    text = "T-99, touch point 1."
    place.until(lambda: place.presenter.screen.instruction.text == text, "the trial's screen")
    assert place.replay is place.loop.latest
    assert place.state.training.trial_id != before
    place.submit("Abort")
    place.until_menu("experiment")
