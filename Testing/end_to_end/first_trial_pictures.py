"""Make the pictures of docs/first-trial.md: python -m Testing.end_to_end.first_trial_pictures.

They are what the window shows to somebody who starts the simulator alone and works with the keys;
commands carry the tip, and one touch is far off its point.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.number_text import with_units
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.transforms import MM_PER_M
from Testing.end_to_end.hands import KeyHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import CarriedTrainee
from Testing.end_to_end.window_pictures import Photographer

FOLDER = Path(__file__).parents[2] / "docs" / "pictures"
SIZE = (1280, 720)
NEAR_MM, PRESSED_MM = 12.0, 0.25
SLIP_AT, SLIP_M = 6, 0.006
"""After so many touches one is off by this much."""


def main() -> None:
    """Make all of them."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Lab(Path(folder), "--seed", "7", order="fixed", tutorial="required") as lab,
    ):
        window = lab.open_window("window", SIZE)
        photographer = Photographer(lab, window, FOLDER)
        with Client(port=lab.simulator.port) as client:
            # It only carries the tip: the simulator is to score alone.
            hello = {"protocolVersion": PROTOCOL_VERSION, "client": "carrier", "scores": False}
            assert client.send_command("Hello", hello, timeout=60).ok
            trainee = CarriedTrainee(lab.view, KeyHands(lab.keyboard), client)
            keep_menus(trainee, photographer)
            keep_tutorial(trainee, photographer)
            keep_trial(trainee, photographer)
            keep_result(trainee, photographer)


def keep_menus(trainee: CarriedTrainee, photographer: Photographer) -> None:
    trainee.until_menu("start")
    trainee.focus("introduction")
    trainee.focus("train")
    photographer.keep("first-trial-01-start")
    trainee.choose("train")
    trainee.read_on("controls")
    photographer.keep("first-trial-02-controls")
    trainee.choose("next")
    trainee.until_menu("experiment")
    trainee.focus("tutorial")
    photographer.keep("first-trial-03-experiment")


def keep_tutorial(trainee: CarriedTrainee, photographer: Photographer) -> None:
    trainee.choose("tutorial")
    first = with_units("30 mm")
    trainee.until(lambda: first in trainee.view.screen.instruction.text, "the first step")
    photographer.keep("first-trial-04-tutorial")
    trainee.press("menu", lambda: trainee.menu_name == "tutorial", "the tutorial's menu")
    trainee.choose("leave")
    trainee.until_menu("experiment")
    trainee.focus("skip")
    trainee.press("accept", lambda: "skip" not in names_in(trainee), "the skipped trial run")


def names_in(trainee: CarriedTrainee) -> list[str]:
    return [] if trainee.menu is None else [item.name for item in trainee.menu.items]


def keep_trial(trainee: CarriedTrainee, photographer: Photographer) -> None:
    trainee.begin_task("task-1")
    trainee.until(lambda: trainee.view.state["phase"] == "running", "the trial")
    photographer.keep("first-trial-05-task")
    trainee.approach("1", 0.004)
    carry_over(trainee, "1", NEAR_MM, "near")
    photographer.keep("first-trial-06-near")
    carry_over(trainee, "1", -PRESSED_MM, "on skin")
    photographer.keep("first-trial-07-on-skin")
    trainee.have_touched(SLIP_AT)
    label = trainee.view.state["next"]
    slip(trainee, label)
    trainee.have_touched(15)
    trainee.press("touch", lambda: trainee.menu_name == "complete", "the choice")
    photographer.keep("first-trial-08-register")
    trainee.choose("register")
    trainee.until_menu("result")


def carry_over(trainee: CarriedTrainee, label: str, height_mm: float, stage: str) -> None:
    """Carry the tip so far above a point, and wait for a stage of the touch."""
    place, center = MM_PER_M * trainee.place_of(label), MM_PER_M * trainee.head_center
    above = place + height_mm * (place - center) / np.linalg.norm(place - center)
    trainee.send_tip(above.tolist(), 20.0)
    trainee.until(lambda: trainee.view.state["touch"] == stage, stage)


def slip(trainee: CarriedTrainee, label: str) -> None:
    """Touch the skin next to a point."""
    trainee.approach(label, 0.004)
    place, center = trainee.place_of(label), trainee.head_center
    aside = np.cross(place - center, (0.0, 0.0, 1.0))
    beside = place + SLIP_M * aside / np.linalg.norm(aside)
    onto = MM_PER_M * (beside - 0.01 * (beside - center) / np.linalg.norm(beside - center))
    trainee.send_tip(onto.tolist(), 100.0)
    trainee.until(lambda: trainee.view.state["proximity"] == "contact", "the skin beside a point")
    kept = trainee.touched
    assert trainee.client.send_command("Capture", {}, timeout=60).ok
    trainee.until(lambda: trainee.touched > kept, f"touch {label}")


def keep_result(trainee: CarriedTrainee, photographer: Photographer) -> None:
    # A menu that has opened by itself ignores presses for a moment.
    trainee.until(lambda: trainee.menu is not None and trainee.menu.focus, "a focus")
    photographer.keep("first-trial-09-result")
    trainee.choose("worst")
    trainee.until(lambda: "worst touch" in trainee.view.screen.instruction.text, "the replay")
    photographer.keep("first-trial-10-worst-touch")


if __name__ == "__main__":
    main()
