"""Make the picture of a trial's result: `python -m Testing.end_to_end.result_picture`.

The scripted trainee plays the trial, Slicer's side scores it, and the window shows the result. The
trainee of the session by gamepad would not do: a computer that draws large pictures lets that one
see late, and rest on the head too long.
"""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from rastrainer.igtl.client import Client
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO
from rastrainer_simulator.virtual.scripted_trial import play_trial, say_hello
from Testing.end_to_end.hands import GamepadHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import StreamTrainee

PICTURE = Path(__file__).parents[2] / "Screenshots" / "result.png"
WINDOW = ("--size", "1920x1080", "--quality", "low", "--picture-quality", "high")
DRAWN_S = 600.0
SEED = 9


def main() -> None:
    """Make the picture."""
    with tempfile.TemporaryDirectory() as folder, Lab(Path(folder)) as lab:
        # It waits for one trial more, so that it is still there while the result is shown.
        slicer = lab.start_slicer(trials=2)
        with Client(port=lab.simulator.port) as client:
            say_hello(client, "trainee")
            play_trial(client, load_scenario(asset_path(*DEFAULT_SCENARIO)), "task-1", "P7", SEED)
            slicer.told_until("trial")
        trainee = StreamTrainee(lab.view, GamepadHands(lab.simulator))
        trainee.until_menu("result")
        # The hints are those of the device in use.
        trainee.focus("errors")
        trainee.focus("next")
        window = lab.open_window("window", *WINDOW)
        known = set(window.folder.glob("*.png"))
        lab.keyboard.tap("F12")
        shutil.copyfile(window.next_picture(known, DRAWN_S), PICTURE)


if __name__ == "__main__":
    main()
