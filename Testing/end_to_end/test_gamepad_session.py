"""A session by gamepad alone: from the start menu to the result, felt, heard in the window, scored.

During the trial Slicer's side crashes and returns; in the next one the gamepad is unplugged.
"""

from __future__ import annotations

import time
from itertools import groupby

import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer_simulator.texts.texts import Texts
from Testing.end_to_end.hands import GamepadHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import Trainee
from Testing.end_to_end.window_process import WindowProcess

# A window that the processor draws needs the machine to itself.
pytestmark = pytest.mark.soak

STEADY_S = 0.4
TRAINEE = "P7"
CRASH_AFTER = 9
TEXTS = Texts()
LOST = TEXTS.say("warning.slicer")
UNPLUGGED = TEXTS.say("warning.unplugged", name="Virtual F310")
EVENTS = {"touch", "proximity-in", "proximity-out", "error", "finish"}
SOUNDS = ("touch", "proximity", "error", "finish")


class SteadyTrainee(Trainee):
    """Waits for the window, so that no two sounds coincide."""

    def __init__(self, lab: Lab, window: WindowProcess):
        super().__init__(lab.view, GamepadHands(lab.simulator))
        self._window = window

    @property
    def kinds(self) -> list[str]:
        """The kinds of all events so far."""
        return [event["kind"] for event in self.view.events]

    def catch_up(self) -> None:
        self._window.wait_for_tick(self.view.state["tick"])

    def begin_task(self, task: str) -> None:
        super().begin_task(task)
        self._window.page.wait_for_selector(f"body[data-scene={task}]")
        self.until_running()

    def touch(self, label: str) -> None:
        self.catch_up()
        self.approach(label, 0.02)
        self.catch_up()
        self.press_on(label)

    def type_by_gamepad(self, text: str) -> None:
        """Type on the screen's own keyboard: rows in which a letter is chosen, and accepted."""
        self.choose("trainee")
        self.until_menu("keyboard")
        for typed, letter in enumerate(text, start=1):
            row = next(item.name for item in self.menu.items if letter in item.value)
            self.focus(row)
            while not self._is_chosen(row, letter):
                before = self.value(row)
                direction = "right" if before.index("[") < before.index(letter) else "left"
                self.press(direction, lambda r=row, b=before: self.value(r) != b, letter)
            wanted = f"{text[:typed]}_"
            self.press("accept", lambda w=wanted: self.menu.facts[0].value == w, letter)
        self.choose("done")
        self.until_menu("experiment")

    def _is_chosen(self, row: str, letter: str) -> bool:
        """Return whether a letter is chosen, and stays so: a key that is held long goes farther."""
        chosen = f"[{letter}]"
        if chosen in self.value(row):
            time.sleep(STEADY_S)
        return chosen in self.value(row)


def test_a_session_by_gamepad_survives_a_crash_of_slicers_side_and_an_unplugged_gamepad(tmp_path):
    with Lab(tmp_path, "--speed", "4", "--seed", "7") as lab:
        slicer = lab.start_slicer()
        window = lab.open_window("window", (960, 540))
        trainee = SteadyTrainee(lab, window)
        trainee.until_menu("start")
        trainee.go_to_experiment()
        trainee.type_by_gamepad(TRAINEE)
        trainee.begin_task("task-1")
        trainee.press("touch", lambda: "error" in trainee.kinds, "an error")
        for number in range(1, CRASH_AFTER + 1):
            trainee.touch(str(number))
        slicer.kill()
        trainee.until_warned(LOST)
        trainee.touch(str(CRASH_AFTER + 1))
        assert trainee.view.state["phase"] == "running"
        assert trainee.touched == CRASH_AFTER + 1
        # It waits for one more trial, so that it is still running while the result is shown.
        slicer = lab.start_slicer(trials=2)
        for number in range(CRASH_AFTER + 2, 16):
            trainee.touch(str(number))
        trainee.until_warned(LOST, False)
        trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
        trainee.until_menu("complete")
        trainee.choose("register")
        record = slicer.results()["record"]
        assert (record["trainee"], record["task"]) == (TRAINEE, "task-1")
        labels = [point["label"] for point in record["points"]]
        assert labels == [str(number) for number in range(1, 16)]
        trainee.until_menu("result")
        assert trainee.menu.facts[0].label == "Score"
        check_felt(trainee, lab.simulator.felt())
        trainee.choose("next")
        trainee.until_menu("experiment")
        unplug_and_resume(lab, trainee)
        sounds = [event["sound"] for event in lab.view.events]
        heard = window.heard()
        assert {name: heard.count(name) for name in SOUNDS} == {
            name: sounds.count(name) for name in SOUNDS
        }


def check_felt(trainee: SteadyTrainee, felt: list[tuple[float, float]]) -> None:
    """Each event is sent once, and felt once."""
    events, kinds = trainee.view.events, trainee.kinds
    assert set(kinds) >= EVENTS
    assert [event["number"] for event in events] == list(range(1, len(events) + 1))
    assert (kinds.count("touch"), kinds.count("error"), kinds.count("finish")) == (15, 1, 1)
    wanted = [event["rumble"] for event in events if event["rumble"] > 0.0]
    strengths = [strength for strength, _ in felt if strength > 0.0]
    assert strengths == pytest.approx(wanted, abs=1e-4)


def unplug_and_resume(lab: Lab, trainee: SteadyTrainee) -> None:
    """Lose the gamepad while its stick is pushed; the keyboard resumes, and nothing is lost."""
    trainee.begin_task("task-2")
    trainee.touch("1")
    trainee.catch_up()
    trainee.hands.push(0.0, 0.0, 1.0, False)
    trainee.until_moved()
    lab.simulator.unplug()
    trainee.until_warned(UNPLUGGED)
    trainee.until_still()
    trainee.until_menu("trial")
    assert trainee.view.state["phase"] == "paused"
    trainee.until(lambda: trainee.menu.focus == "resume", "the focus")
    lab.keyboard.tap("Enter")
    trainee.until_menu(None)
    lab.keyboard.hold("KeyR", True)
    trainee.until_moved()
    lab.keyboard.hold("KeyR", False)
    trainee.until_still()
    lab.simulator.plug_in()
    trainee.until_warned(UNPLUGGED, False)
    trainee.touch("2")
    assert trainee.view.state["touched"] == ["1", "2"]
    records = [read_journal(path) for path in lab.records.glob("*.journal")]
    (journal,) = [record for record in records if record.header.task == "task-2"]
    assert [touch["label"] for touch in journal.of_kind("touch")] == ["1", "2"]
    inputs = [entry["operator"] for entry in journal.of_kind("input")]
    operators = [name for name, _group in groupby(filter(None, inputs))]
    assert operators == ["gamepad", "keyboard", "gamepad"]
