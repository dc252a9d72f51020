"""Make the pictures of the window for the README: python -m Testing.end_to_end.window_pictures.

The tip is carried to the points by commands, and the trial of the result is a scripted trainee's: a
hand that looks at a computer which draws large pictures sees late, and rests on the head too long.
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

from rastrainer.igtl.client import Client
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO
from rastrainer_simulator.presentation.look import FLIGHT_S
from rastrainer_simulator.virtual.scripted_trial import play_trial, send_hello
from Testing.end_to_end.hands import GamepadHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import CarriedTrainee
from Testing.end_to_end.virtual_display import VirtualKeyboard
from Testing.end_to_end.window_process import WindowProcess
from Testing.pictures import keep_picture

FOLDER = Path(__file__).parents[2] / "Screenshots"
SIZE = (1400, 788)
SEED = 9
TRAINEE = "P7"
TOUCHED = 6
"""Number of points touched in the close-up of the head."""


class Photographer:
    """Takes pictures of the window."""

    def __init__(self, lab: Lab, window: WindowProcess, folder: Path = FOLDER) -> None:
        self._lab, self._window = lab, window
        self._folder = folder

    def keep(self, name: str) -> None:
        """Save a picture, once the view has arrived."""
        if self._lab.view.screen.menu is None:
            # While a menu is open nothing changes, and nothing is drawn again.
            self._window.wait_for_tick(self._lab.view.state["tick"])
        time.sleep(FLIGHT_S + 1.5)
        keep_picture(self._window.page.screenshot(), self._folder / f"{name}.webp")


def main() -> None:
    """Make all of them."""
    with (
        tempfile.TemporaryDirectory() as folder,
        Lab(Path(folder), "--seed", "7", view="never") as lab,
    ):
        window = lab.open_window("window", SIZE)
        photographer = Photographer(lab, window)
        with Client(port=lab.simulator.port) as client:
            send_hello(client, "trainee")
            trainee = CarriedTrainee(lab.view, GamepadHands(lab.simulator), client)
            keep_menus(trainee, photographer, lab.keyboard)
            keep_views(trainee, photographer)
            trainee.go_home()
            # It waits for one more trial, so that it is still running while the result is shown.
            slicer = lab.start_slicer(trials=2)
            scenario = load_scenario(asset_path(*DEFAULT_SCENARIO))
            play_trial(client, scenario, "task-1", TRAINEE, SEED)
            slicer.events_until("trial")
            trainee.until_menu("result")
            # The hints are for the device in use.
            trainee.focus("errors")
            trainee.focus("next")
            photographer.keep("result")


def keep_menus(
    trainee: CarriedTrainee, photographer: Photographer, keyboard: VirtualKeyboard
) -> None:
    trainee.until_menu("start")
    trainee.focus("introduction")
    trainee.focus("train")
    photographer.keep("menu")
    trainee.go_to_experiment()
    trainee.focus("trainee")
    keyboard.hold("ShiftLeft", True)
    keyboard.tap("KeyP")
    trainee.until(lambda: trainee.value("trainee") == "P", "the letter")
    keyboard.hold("ShiftLeft", False)
    keyboard.tap("Digit7")
    trainee.until(lambda: trainee.value("trainee") == TRAINEE, "the ID")
    trainee.focus("trial-run")
    trainee.focus("task-1")
    photographer.keep("experiment")


def keep_views(trainee: CarriedTrainee, photographer: Photographer) -> None:
    """Keep the room from afar, and the head from near, with the tip in the air and as an error."""
    trainee.begin_task("task-1")
    trainee.use_camera("far")
    photographer.keep("far-view")
    trainee.use_camera("close-up")
    trainee.touch_all(TOUCHED)
    label = trainee.view.state["next"]
    trainee.approach(label, 0.004)
    trainee.use_camera("close-up")
    photographer.keep("close-view-free")
    trainee.steer_to(trainee.place_of(label), 0.002)
    trainee.until(lambda: trainee.view.state["touch"] == "on skin", "the skin")
    photographer.keep("close-view-on-skin")
    trainee.press_away_from_fiducials()
    photographer.keep("close-view-proximity")


if __name__ == "__main__":
    main()
