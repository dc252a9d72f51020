"""Save the tutorial's pictures: `python -m Testing.end_to_end.module.tutorial_pictures DIR`."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import slicer
from PySide6 import QtGui

import rastrainer
from rastrainer.slicer.scene.views import jumpTo
from rastrainer.slicer.settings import PROGRAM
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.module.installed_simulator import write_program
from Testing.end_to_end.module.screenshots import DISTANCE_MM, HEAD
from Testing.end_to_end.module.story import PLAN_MM
from Testing.slicer.host.host import Host

OPTIONS = ("--speed", "3", "--no-views", "--no-gamepad")
"""So fast that it does not take long, so slow that the trainee pauses no longer than people do."""
SLIP_AT = 9
AZIMUTH, ELEVATION, ZOOM = 35.0, 20.0, 1.3


class Tutorial:
    """Plays the ten steps, as `docs/tutorial.md` describes them, and takes a picture of each."""

    def __init__(self, host: Host, folder: Path, pictures: Path) -> None:
        self._host = host
        self._pictures = pictures
        self._records = Path.home() / "RASTrainer" / "trials"
        program = write_program(folder / "rastrainer", folder / "simulator.pid", OPTIONS)
        slicer.app.settings().setValue(PROGRAM.key, str(program))

    def play(self) -> None:
        """Play all steps."""
        host = self._host
        host.open()
        self._take("01-open")
        self._next("New trainee")
        self._take("02-connected")
        self._next("Start the trial run")
        host.choose("taskComboBox", "Task 1")
        host.press("showScenarioButton")
        host.check("robotCheckBox")
        host.let_pass(2.0)
        host.look_from(AZIMUTH, ELEVATION, ZOOM)
        self._only("scenario")
        self._take("03-head-and-task")
        self._only("training")
        self._take("04-ready")
        self._play_trial_run()
        self._next("Start Task 1")
        self._next("Pause")
        self._touch(1, 8)
        self._take("05-touching")
        self._touch(9, 15)
        host.look_at(HEAD, AZIMUTH, ELEVATION, DISTANCE_MM)
        self._take("06-registration")
        self._trainee("--register")
        self._wait_for("Show result")
        self._next("Start Task 1")
        host.wait_until(lambda: "Score" in host.text("feedbackText"), "the feedback is there")
        self._take("07-score")
        self._plan()
        self._take("08-plan")
        self._only("score")
        host.wait_until(lambda: host.find("worstTouchButton").enabled, "the trial is judged")
        host.press("worstTouchButton")
        host.wait_until(lambda: "clearance" in host.text("replayText"), "the replay is shown")
        self._take("09-worst-touch")
        self._only("trainees")
        host.unfold("historyTable")
        self._take("10-history")

    def _play_trial_run(self) -> None:
        self._next("Pause")
        self._trainee("--points", "1", "15", "--register")
        self._wait_for("Show result")

    def _plan(self) -> None:
        host = self._host
        self._only("plan")
        host.press("placeTargetButton")
        host.place(*PLAN_MM)
        host.wait_until(lambda: host.find("sendPlanButton").enabled, "the plan can be sent")
        host.press("sendPlanButton")
        host.wait_until(lambda: "shows the plan" in host.text("reachableText"), "it is shown")
        jumpTo(host.scene, PLAN_MM)

    def _touch(self, first: int, last: int) -> None:
        self._trainee("--points", str(first), str(last), "--slip-at", str(SLIP_AT))
        bar = self._host.find("pointsProgressBar")
        self._host.wait_until(lambda: bar.value == last, "the touches are shown")

    def _trainee(self, *words: str) -> None:
        logic = Path(rastrainer.__file__).parents[1]
        command = [sys.executable, "-m", "Testing.slicer.real.tour_trainee", "--logic", str(logic)]
        command += ["--scenario", str(asset_path("scenarios", "colin27"))]
        command += ["--records", str(self._records)]
        command += ["--port", str(self._host.find("portSpinBox").value), *words]
        process = subprocess.Popen(command)
        self._host.wait_until(lambda: process.poll() is not None, "the trainee is done")
        assert process.returncode == 0

    def _next(self, until: str) -> None:
        self._host.press("nextStepButton")
        self._wait_for(until)

    def _wait_for(self, title: str) -> None:
        host = self._host
        host.wait_until(lambda: host.text("nextStepButton") == title, f"it says {title}")

    def _only(self, shown: str) -> None:
        """Fold every section but one, as the steps do; this one may be no step."""
        for name in ("scenario", "trainees", "training", "registration", "plan", "score"):
            self._host.find(f"{name}CollapsibleButton").collapsed = name != shown
        self._host.process_events()

    def _take(self, name: str) -> None:
        """Save a picture in few colors: the repository is to stay small."""
        self._host.let_pass(0.5)
        path = self._pictures / f"tutorial-{name}.png"
        self._host.window_screenshot(path)
        few = QtGui.QImage.Format.Format_Indexed8
        QtGui.QImage(str(path)).convertToFormat(few).save(str(path))


def save_all(pictures: Path) -> None:
    """Play the tutorial and save its pictures."""
    with tempfile.TemporaryDirectory() as temporary:
        host = Host(Path(temporary, "computer of the instructor"))
        try:
            Tutorial(host, Path(temporary), pictures).play()
        finally:
            host.close()


if __name__ == "__main__":
    save_all(Path(sys.argv[1]))
