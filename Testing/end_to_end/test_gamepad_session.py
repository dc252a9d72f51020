"""From the start menu to the result by a gamepad alone, seen in the window and scored in Slicer."""

from __future__ import annotations

import os
import shutil
import time
from pathlib import Path

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

from rastrainer_simulator.desktop.flight import FLIGHT_S
from Testing.end_to_end.hands import GamepadHands
from Testing.end_to_end.lab import Lab, trial_of
from Testing.end_to_end.stream_trainee import StreamTrainee

SCREENSHOTS = Path(__file__).parents[2] / "Screenshots"
SPEED = "4"
STEADY_S = 0.4
SETTLED_S = FLIGHT_S + 0.5
WANTS_SCREENSHOTS = bool(os.environ.get("RASTRAINER_SCREENSHOTS"))
QUALITY = ("--quality", "low", "--picture-quality", "high" if WANTS_SCREENSHOTS else "low")
TRAINEE = "P7"


class Photographer:
    """Has the window keep pictures."""

    def __init__(self, lab: Lab, window):
        self._lab, self._window = lab, window
        self.pictures: dict[str, Path] = {}

    def keep(self, name: str) -> None:
        # The window draws what this test has read already.
        time.sleep(SETTLED_S)
        known = set(self._window.folder.glob("*.png"))
        self._lab.keyboard.tap("F12")
        self.pictures[name] = self._window.next_picture(known)


def type_by_gamepad(trainee: StreamTrainee, text: str) -> None:
    """Type on the screen's own keyboard: rows in which a letter is chosen, and accepted."""
    trainee.choose("trainee")
    trainee.until_menu("keyboard")
    for typed, letter in enumerate(text, start=1):
        row = next(item.name for item in trainee.menu.items if letter in item.value)
        trainee.focus(row)
        while not is_chosen(trainee, row, letter):
            before = trainee.value(row)
            way = "right" if before.index("[") < before.index(letter) else "left"
            trainee.press(way, lambda r=row, b=before: trainee.value(r) != b, letter)
        wanted = f"{text[:typed]}_"
        trainee.press("accept", lambda w=wanted: trainee.menu.facts[0].value == w, letter)
    trainee.choose("done")
    trainee.until_menu("experiment")


def is_chosen(trainee: StreamTrainee, row: str, letter: str) -> bool:
    """Tell whether a letter is chosen, and stays so: a key that is held long goes farther."""
    chosen = f"[{letter}]"
    if chosen in trainee.value(row):
        time.sleep(STEADY_S)
    return chosen in trainee.value(row)


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> dict:
    """Play the whole flow; return what came of it."""
    folder = tmp_path_factory.mktemp("gamepad")
    with Lab(folder, "--speed", SPEED, "--seed", "7") as lab:
        slicer = lab.start_slicer()
        window = lab.open_window(
            "window", "--size", "1920x1080", "--quality", "low", "--picture-quality", "low"
        )
        trainee = StreamTrainee(lab.view, GamepadHands(lab.simulator))
        photographer = Photographer(lab, window)
        to_experiment(trainee, photographer)
        practice(trainee, photographer)
        trainee.choose("task-1")
        trainee.until_menu(None)
        play(trainee, photographer)
        trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
        trainee.until_menu("complete")
        trainee.choose("register")
        results = trial_of(slicer)
        trainee.until_menu("result")
        photographer.keep("result")
        return {
            "results": results,
            "menu": trainee.menu,
            "pictures": photographer.pictures,
            "events": lab.view.events,
            "felt": lab.simulator.felt(),
        }


def to_experiment(trainee: StreamTrainee, photographer: Photographer) -> None:
    trainee.until_menu("start")
    photographer.keep("menu")
    trainee.choose("train")
    trainee.until_menu("introduction")
    trainee.press("accept", lambda: trainee.menu.name == "controls", "the controls")
    trainee.choose("next")
    trainee.until_menu("experiment")
    type_by_gamepad(trainee, TRAINEE)
    photographer.keep("experiment")


def practice(trainee: StreamTrainee, photographer: Photographer) -> None:
    """Begin the trial run, look around, and end it."""
    trainee.choose("trial-run")
    trainee.until_menu(None)
    trainee.press("camera", lambda: trainee.view.state["camera"] == "far", "the far camera")
    trainee.until(lambda: len(trainee.view.scene["fiducials"]) == 15, "the scene of the task")
    photographer.keep("far-view")
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.choose("finish")
    trainee.until_menu("experiment")


def play(trainee: StreamTrainee, photographer: Photographer) -> None:
    if trainee.view.state["camera"] != "close-up":
        is_close = lambda: trainee.view.state["camera"] == "close-up"  # noqa: E731
        trainee.press("camera", is_close, "the close camera")
    for number in range(1, 16):
        label = str(number)
        trainee.approach(label, 0.02)
        if number == 7:
            trainee.hands.push(0.0, 0.0, 0.0, False)
            photographer.keep("close-view-free")
        trainee.press_on(label)
        if number == 7:
            photographer.keep("close-view-proximity")


def test_slicer_scores_the_trial_of_that_trainee(session):
    results = session["results"]["results"]
    assert results["trainee"] == TRAINEE
    assert results["task"] == "task-1"
    assert session["menu"].facts[0].label == "Score"


def test_each_touch_is_heard_and_felt_once(session):
    kinds = [event["kind"] for event in session["events"]]
    assert kinds.count("touch") == 15
    assert kinds.count("finish") == 1
    assert [event["number"] for event in session["events"]] == sorted(
        {event["number"] for event in session["events"]}
    )
    assert any(strength > 0 for strengths in session["felt"] for strength in strengths)


def test_proximity_is_left_as_often_as_it_is_entered(session):
    kinds = [event["kind"] for event in session["events"]]
    near, away = kinds.count("proximity-in"), kinds.count("proximity-out")
    assert near >= 15
    assert abs(near - away) <= 1


def test_the_window_shows_each_step_of_the_flow(session):
    """Pictures of the whole window; `RASTRAINER_SCREENSHOTS=1` keeps them in the best light."""
    for name, path in session["pictures"].items():
        pixels = read_png(path)
        assert pixels.shape == (1080, 1920, 3)
        assert pixels.std() > 20, name
        if WANTS_SCREENSHOTS:
            shutil.copyfile(path, SCREENSHOTS / f"{name}.png")
    red, blue = ((200, 0, 0), (255, 60, 60)), ((0, 30, 190), (70, 125, 255))
    free = read_png(session["pictures"]["close-view-free"])[200:950, 300:1400]
    near = read_png(session["pictures"]["close-view-proximity"])[200:950, 300:1400]
    assert count(free, blue) > 50 > count(free, red)
    assert count(near, red) > 20


def read_png(path: Path) -> np.ndarray:
    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, 3)
    return pixels[::-1]


def count(pixels: np.ndarray, color) -> int:
    return int(np.all((pixels >= color[0]) & (pixels <= color[1]), axis=2).sum())
