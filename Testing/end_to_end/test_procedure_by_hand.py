"""A biopsy from the menu to the result, by gamepad alone and by the keys of a page alone.

Slicer's side registers the touches and scores the trial.
"""

from __future__ import annotations

import threading
import time
from contextlib import suppress

import pytest

from rastrainer.journal.journal_file import read_journal
from Testing.end_to_end.hands import GamepadHands, KeyHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.procedure_trainee import ALIGNED_DEG, ALIGNED_MM, ProcedureTrainee
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.test_gamepad_session import type_by_gamepad
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient

# Fifteen touches and a whole procedure by hand take minutes.
pytestmark = pytest.mark.soak

SPEED = "3"
PRESSED_S, ALIVE_S = 0.02, 0.1
TRAINEE = "P7"
TITLE = "Biopsy of a frontal lesion"
PAST_INNER_MM = 1.0
D_PAD_FROM = 0.3
TURNS = (("KeyJ", "KeyL"), ("KeyK", "KeyI"))


class TurningGamepad(GamepadHands):
    """Turns the guide by the right stick to the sides, by the D-pad up and down."""

    def turn(self, right: float, up: float, fine: bool) -> None:
        self._simulator.move(rightx=right, righttrigger=1.0 if fine else 0.0)
        for button, sign in (("dpup", 1.0), ("dpdown", -1.0)):
            self._simulator.press(button, sign * up > D_PAD_FROM)


class TurningKeys(KeyHands):
    """Turns the guide by the keys J, L, K and I."""

    def turn(self, right: float, up: float, fine: bool) -> None:
        self._hold((right, up), TURNS, fine)


class PageKeyboard:
    """The keys of a page, as it sends them, with its signs of life."""

    def __init__(self, client: ViewClient):
        self._client = client
        threading.Thread(target=self._live, daemon=True).start()

    def _live(self) -> None:
        with suppress(Exception):
            while True:
                self._client.send({"type": "alive"})
                time.sleep(ALIVE_S)

    def tap(self, code: str) -> None:
        self.hold(code, True)
        time.sleep(PRESSED_S)
        self.hold(code, False)

    def hold(self, code: str, is_down: bool) -> None:
        is_typed = is_down and code.startswith(("Key", "Digit"))
        text = code[-1].lower() if is_typed else ""
        self._client.send({"type": "key", "code": code, "isDown": is_down, "text": text})


@pytest.fixture(scope="module", params=["gamepad", "keyboard"])
def operated(tmp_path_factory, request) -> dict:
    """Carry out the biopsy; return the results."""
    device = request.param
    folder = tmp_path_factory.mktemp(device)
    options = () if device == "gamepad" else ("--no-gamepad",)
    with (
        Lab(folder, "--speed", SPEED, "--seed", "11", *options) as lab,
        LoopThread() as thread,
        ViewClient(thread, lab.url, lab.key) as client,
    ):
        if device == "gamepad":
            return operate(ProcedureTrainee(lab.view, TurningGamepad(lab.simulator)), lab, device)
        page = WatchingView(client)
        return operate(ProcedureTrainee(page, TurningKeys(PageKeyboard(client))), lab, device)


def operate(trainee: ProcedureTrainee, lab: Lab, device: str) -> dict:
    slicer = lab.start_slicer()
    begin(trainee, device)
    for number in range(1, 16):
        trainee.touch(str(number))
    trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
    trainee.until_menu("complete")
    trainee.choose("register")
    trainee.until(lambda: "FRE" in trainee.view.screen.instruction.text, "a registration")
    trainee.touch("checkpoint")
    seen = {"checked": trainee.view.screen}
    trainee.next_step("accept", "aligning")
    trainee.align_by_hand()
    seen["aligned"] = trainee.procedure["aim"]
    trainee.next_step("lock", "drilling")
    trainee.until(lambda: trainee.view.screen.ruler is not None, "the ruler")
    trainee.feed_to(trainee.ruler.inner_mm + PAST_INNER_MM)
    trainee.next_step("insert", "inserting")
    trainee.feed_to(trainee.ruler.target_mm)
    seen["inserted"] = trainee.procedure, trainee.ruler
    trainee.next_step("release", "registered")
    trainee.until_menu("result")
    seen["slicer"] = slicer.events_until("trial")[-1]["results"]
    seen["result"] = trainee.menu
    trainee.choose("procedure")
    trainee.until_menu("procedure-errors")
    seen["errors"] = trainee.menu
    trainee.choose("lines")
    trainee.until(lambda: len(trainee.view.screen.errors) == 3, "the lines")
    (journal,) = lab.records.glob("*.journal")
    reading = read_journal(journal)
    seen["scored"] = reading.of_kind("scored")[-1]["arguments"]["details"]["procedure"]
    seen["operators"] = {each["operator"] for each in reading.of_kind("input")} - {""}
    return seen | {"device": device, "events": [each["kind"] for each in lab.view.events]}


def begin(trainee: ProcedureTrainee, device: str) -> None:
    """Choose the biopsy after Task 1, whose fiducials are touched first."""
    trainee.read_introduction()
    if device == "gamepad":
        type_by_gamepad(trainee, TRAINEE)
    else:
        trainee.focus("trainee")
        trainee.hands.type(TRAINEE)
    trainee.focus("procedure")
    while trainee.value("procedure") != TITLE:
        before = trainee.value("procedure")
        trainee.press("right", lambda b=before: trainee.value("procedure") != b, "another one")
    trainee.begin_task("task-1")


def test_the_whole_procedure_is_carried_out_with_that_device_alone(operated):
    assert operated["operators"] == {operated["device"]}


def test_a_checkpoint_is_touched_and_its_error_shown(operated):
    texts = operated["checked"].status
    assert any("mm off" in text for text in texts)
    assert "checkpoint" in operated["events"]


def test_the_guide_is_brought_onto_the_line_by_hand_with_the_bulls_eye(operated):
    aim = operated["aligned"]
    assert aim["entryDistanceMm"] <= ALIGNED_MM
    assert aim["angleDeg"] <= ALIGNED_DEG
    (line,) = operated["scored"]["trajectories"]
    assert line["angleByHandDeg"] <= ALIGNED_DEG + 0.1
    assert line["radialByHandMm"] <= 3.0


def test_the_ruler_brings_drill_and_needle_to_their_depths(operated):
    procedure, ruler = operated["inserted"]
    assert procedure["feedMm"] == pytest.approx(ruler.target_mm, abs=1.0)
    assert {"bone", "through"} <= set(operated["events"])
    assert "blocked" not in operated["events"]
    (line,) = operated["scored"]["trajectories"]
    assert abs(line["depthByHandMm"]) <= 1.5


def test_slicers_side_scores_the_touches_and_the_procedure(operated):
    assert operated["slicer"]["task"] == "task-1"
    score = operated["result"].facts[0].value
    assert score.startswith(f"{operated['slicer']['procedure']['score']['score']:.0f}")
    (line,), (shown,) = (
        operated["slicer"]["procedure"]["trajectories"],
        operated["scored"]["trajectories"],
    )
    assert line["targetPointError"]["mm"] == shown["targetMm"]


def test_the_errors_are_shown(operated):
    labels = [fact.label for fact in operated["result"].facts]
    assert labels[:2] == ["Score of the procedure", "Target point error (RMS)"]
    assert "Target point error" in [fact.label for fact in operated["errors"].facts]
