"""A session by gamepad alone: from the start menu to the result, drawn in the window, scored in
Slicer.

During the trial Slicer's side crashes and returns; in the next one the gamepad is unplugged.
"""

from __future__ import annotations

import time
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer_simulator.scene.nodes import TIP_ERROR, TIP_FREE, Material
from rastrainer_simulator.texts.texts import Texts
from Testing.end_to_end.hands import GamepadHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import StreamTrainee
from Testing.end_to_end.window_process import WindowProcess
from Testing.read_png import read_png

# A window that the processor draws needs the machine to itself.
pytestmark = pytest.mark.soak

WIDTH, HEIGHT = 960, 540
SPEED = "4"
STEADY_S = 0.4
SETTLED_S = 0.1
TRAINEE = "P7"
CRASH_AFTER = 9
TEXTS = Texts()
LOST = TEXTS.say("warning.slicer")
UNPLUGGED = TEXTS.say("warning.unplugged", name="Virtual F310")
EVENTS = ("touch", "proximity-in", "proximity-out", "contact", "error", "finish")
SOUNDS = ("touch", "proximity", "contact", "error", "finish")


class Photographer:
    """Takes pictures of the window, and waits for it."""

    def __init__(self, lab: Lab, window: WindowProcess, folder: Path):
        self._lab, self._window, self._folder = lab, window, folder
        self.pictures: dict[str, Path] = {}

    def catch_up(self) -> None:
        """Wait until the window shows what this test has read, so that no two sounds coincide."""
        self._window.wait_for_tick(self._lab.view.state["tick"])

    def begin(self, trainee: StreamTrainee, task: str) -> None:
        """Begin a task, and wait until presses count: the window has drawn its scene."""
        trainee.begin_task(task)
        self._window.page.wait_for_selector(f"body[data-scene={task}]")
        trainee.until_running()

    def keep(self, name: str) -> None:
        if self._lab.view.screen.menu is None:
            self.catch_up()
        time.sleep(SETTLED_S)
        self.pictures[name] = self._folder / f"{name}.png"
        self._window.page.screenshot(path=self.pictures[name])


def type_by_gamepad(trainee: StreamTrainee, text: str) -> None:
    """Type on the screen's own keyboard: rows in which a letter is chosen, and accepted."""
    trainee.choose("trainee")
    trainee.until_menu("keyboard")
    for typed, letter in enumerate(text, start=1):
        row = next(item.name for item in trainee.menu.items if letter in item.value)
        trainee.focus(row)
        while not is_chosen(trainee, row, letter):
            before = trainee.value(row)
            direction = "right" if before.index("[") < before.index(letter) else "left"
            trainee.press(direction, lambda r=row, b=before: trainee.value(r) != b, letter)
        wanted = f"{text[:typed]}_"
        trainee.press("accept", lambda w=wanted: trainee.menu.facts[0].value == w, letter)
    trainee.choose("done")
    trainee.until_menu("experiment")


def is_chosen(trainee: StreamTrainee, row: str, letter: str) -> bool:
    """Return whether a letter is chosen, and stays so: a key that is held long goes farther."""
    chosen = f"[{letter}]"
    if chosen in trainee.value(row):
        time.sleep(STEADY_S)
    return chosen in trainee.value(row)


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> dict:
    """Play the whole flow; return the results."""
    folder = tmp_path_factory.mktemp("gamepad")
    with Lab(folder, "--speed", SPEED, "--seed", "7") as lab:
        slicer = lab.start_slicer()
        window = lab.open_window("window", (WIDTH, HEIGHT))
        trainee = StreamTrainee(lab.view, GamepadHands(lab.simulator))
        photographer = Photographer(lab, window, folder)
        to_experiment(trainee, photographer)
        practice(trainee, photographer)
        photographer.begin(trainee, "task-1")
        play(trainee, photographer, range(1, CRASH_AFTER + 1))
        slicer.kill()
        photographer.catch_up()
        crash = report_crash(trainee, str(CRASH_AFTER + 1))
        # It waits for one more trial, so that it is still running while the result is shown.
        slicer = lab.start_slicer(trials=2)
        play(trainee, photographer, range(CRASH_AFTER + 2, 16))
        trainee.until_not_warned(LOST)
        trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
        trainee.until_menu("complete")
        trainee.choose("register")
        slicer_events = slicer.events_until("trial")
        trainee.until_menu("result")
        photographer.keep("result")
        played = {
            "slicer_events": slicer_events,
            "crash": crash,
            "menu": trainee.menu,
            "felt": lab.simulator.felt(),
            "felt_events": list(lab.view.events),
        }
        unplugged = unplug_and_resume(lab, trainee, photographer)
        return {
            **played,
            "unplugged": unplugged,
            "pictures": photographer.pictures,
            "events": list(lab.view.events),
            "heard": window.heard(),
        }


def to_experiment(trainee: StreamTrainee, photographer: Photographer) -> None:
    trainee.until_menu("start")
    photographer.keep("menu")
    trainee.read_introduction()
    type_by_gamepad(trainee, TRAINEE)
    photographer.keep("experiment")


def practice(trainee: StreamTrainee, photographer: Photographer) -> None:
    """Begin the trial run, look around, and end it."""
    photographer.begin(trainee, "trial-run")
    trainee.use_camera("far")
    photographer.keep("far-view")
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.choose("finish")
    trainee.until_menu("experiment")


def play(trainee: StreamTrainee, photographer: Photographer, numbers: range) -> None:
    """Touch fiducials in their order; before the first one touch nothing, which is refused."""
    trainee.use_camera("close-up")
    if numbers.start == 1:
        trainee.press("touch", lambda: "error" in kinds(trainee.view.events), "an error")
    for number in numbers:
        label = str(number)
        photographer.catch_up()
        trainee.approach(label, 0.02)
        photographer.catch_up()
        if number == 7:
            trainee.hover(label)
            photographer.keep("close-view-free")
        trainee.press_on(label)
        if number == 7:
            trainee.press_away_from_fiducials()
            photographer.keep("close-view-proximity")


def report_crash(trainee: StreamTrainee, label: str) -> dict:
    """Touch a fiducial while Slicer's side is away; return the state of the trial then."""
    trainee.until_warned(LOST)
    trainee.touch(label)
    state = trainee.view.state
    return {"phase": state["phase"], "touched": state["touched"], "warnings": trainee.warnings}


def unplug_and_resume(lab: Lab, trainee: StreamTrainee, photographer: Photographer) -> dict:
    """Lose the gamepad in the next task while its stick is pushed; return the results."""
    trainee.choose("next")
    trainee.until_menu("experiment")
    photographer.begin(trainee, "task-2")
    photographer.catch_up()
    trainee.touch("1")
    photographer.catch_up()
    trainee.hands.push(0.0, 0.0, 1.0, False)
    trainee.until_moved()
    lab.simulator.unplug()
    trainee.until_warned(UNPLUGGED)
    trainee.until_still()
    trainee.until_menu("trial")
    phase = trainee.view.state["phase"]
    trainee.until(lambda: trainee.menu.focus == "resume", "the focus")
    for is_down in (True, False):
        lab.keyboard.hold("Enter", is_down)
    trainee.until_menu(None)
    lab.keyboard.hold("KeyR", True)
    trainee.until_moved()
    lab.keyboard.hold("KeyR", False)
    trainee.until_still()
    lab.simulator.plug_in()
    trainee.until_not_warned(UNPLUGGED)
    trainee.touch("2")
    records = [read_journal(path) for path in lab.records.glob("*.journal")]
    (journal,) = [record for record in records if record.header.task == "task-2"]
    return {"phase": phase, "touched": trainee.view.state["touched"], "journal": journal}


def kinds(events: list[dict]) -> list[str]:
    return [event["kind"] for event in events]


def test_slicer_scores_the_trial_of_that_trainee(session):
    results = session["slicer_events"][-1]["results"]
    assert results["record"]["trainee"] == TRAINEE
    assert results["record"]["task"] == "task-1"
    assert session["menu"].facts[0].label == "Score"


def test_the_trial_continues_without_slicers_side_and_the_window_says_so(session):
    crash = session["crash"]
    assert crash["phase"] == "running"
    assert crash["touched"] == [str(number) for number in range(1, CRASH_AFTER + 2)]
    assert LOST in crash["warnings"]


def test_slicers_side_rejoins_the_running_trial_and_receives_all_of_it(session):
    points = [event["label"] for event in session["slicer_events"] if event["event"] == "point"]
    assert points == [str(number) for number in range(1, 16)]
    assert session["slicer_events"][-1]["event"] == "trial"


def test_unplugging_the_gamepad_stops_the_arm_and_loses_nothing(session):
    unplugged = session["unplugged"]
    # The arm's stop and the warning are waited for; the keyboard resumes the trial.
    assert unplugged["phase"] == "paused"
    assert unplugged["touched"] == ["1", "2"]
    touches = unplugged["journal"].of_kind("touch")
    assert [touch["label"] for touch in touches] == ["1", "2"]
    inputs = [entry["operator"] for entry in unplugged["journal"].of_kind("input")]
    operators = [name for name, _group in groupby(filter(None, inputs))]
    assert operators == ["gamepad", "keyboard", "gamepad"]


def test_each_event_is_sent_once_and_felt_once(session):
    events = session["felt_events"]
    assert set(EVENTS) <= set(kinds(events))
    assert [event["number"] for event in events] == list(range(1, len(events) + 1))
    assert kinds(events).count("touch") == 15
    assert kinds(events).count("error") == kinds(events).count("finish") == 1
    wanted = [event["rumble"] for event in events if event["rumble"] > 0.0]
    felt = [strength for strength, _ in session["felt"] if strength > 0.0]
    assert felt == pytest.approx(wanted, abs=1e-4)


@pytest.mark.parametrize("name", SOUNDS)
def test_each_event_is_heard_once(session, name):
    wanted = [event["sound"] for event in session["events"]].count(name)
    assert wanted > 0
    assert session["heard"].count(name) == wanted


def test_the_window_shows_each_step_of_the_flow(session):
    for name, path in session["pictures"].items():
        pixels = read_png(path)
        assert pixels.shape == (HEIGHT, WIDTH, 3)
        assert pixels.std() > 20, name
    free, near = (
        middle(read_png(session["pictures"][f"close-view-{name}"]))
        for name in ("free", "proximity")
    )
    few = WIDTH * HEIGHT / 100_000
    assert count(free, TIP_FREE) > few > count(free, TIP_ERROR)
    assert count(near, TIP_ERROR) > few


def middle(pixels: np.ndarray) -> np.ndarray:
    """Leave out the panels at the picture's edges."""
    return pixels[HEIGHT // 5 : HEIGHT * 7 // 8, WIDTH // 6 : WIDTH * 3 // 4]


def count(pixels: np.ndarray, material: Material) -> int:
    """Return how many pixels have about the color of a glowing material."""
    return int((np.abs(pixels - 255.0 * np.array(material.color)).max(axis=2) < 20.0).sum())
