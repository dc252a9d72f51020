"""Save the tutorial's pictures: `python -m Testing.end_to_end.module.tutorial_pictures DIR`."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import slicer

import rastrainer
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.views import jumpTo
from rastrainer.slicer.settings import PROGRAM
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.module.installed_simulator import write_program
from Testing.end_to_end.module.screenshots import (
    AZIMUTH,
    DISTANCE_MM,
    ELEVATION,
    HEAD,
    ZOOM,
    take,
    temporary_host,
)
from Testing.end_to_end.module.story import PLAN_MM
from Testing.slicer.host.host import Host

OPTIONS = ("--no-views", "--no-gamepad")
"""At the speed of real people: otherwise the trainee would seem to make long pauses."""
SLIP_AT = 9
PATIENCE_S = 1200.0
PROCEDURE = "Biopsy of a frontal lesion"
FROM_THE_RIGHT = -60.0
SECTIONS = ("scenario", "trainees", "training", "registration", "plan", "score")
SECTIONS += ("procedurePlan", "procedure")


class Tutorial:
    """Plays the twelve steps, as `docs/tutorial.md` describes them, and takes a picture of each."""

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
        host.finish_work()
        host.idle_for(2.0)
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
        self._show_slip()
        self._take("06-registration")
        self._trainee("--register")
        self._wait_for("Show result")
        self._next("Start Task 1")
        # The trial run has feedback, too, but no slip.
        slip = f"Point {SLIP_AT} was"
        self._wait_until(lambda: slip in host.text("feedbackText"), "the feedback is shown")
        self._take("07-score")
        self._plan()
        self._take("08-plan")
        self._only("score")
        self._wait_until(lambda: host.find("worstTouchButton").enabled, "the trial is assessed")
        host.press("worstTouchButton")
        self._wait_until(lambda: "clearance" in host.text("replayText"), "the replay is shown")
        self._take("09-worst-touch")
        self._plan_procedure()
        self._take("10-procedure-plan")
        self._carry_out_procedure()
        self._take("11-procedure")
        host.press("releaseButton")
        self._wait_for("Show result")
        self._next("Start Task 1")
        self._only("trainees")
        host.unfold("historyTable")
        jumpTo(host.scene, PLAN_MM)
        self._take("12-history")

    def _play_trial_run(self) -> None:
        self._next("Pause")
        self._trainee("--points", "1", "15", "--register")
        self._wait_for("Show result")

    def _show_slip(self) -> None:
        """Show the touch that is off in all views."""
        host = self._host
        host.choose("residualsTable", SLIP_AT - 1)
        host.finish_work()
        host.find("residualsGroupBox").collapsed = True
        host.look_at(HEAD, FROM_THE_RIGHT, ELEVATION, DISTANCE_MM)

    def _plan(self) -> None:
        host = self._host
        self._only("plan")
        host.press("placeTargetButton")
        host.place(*PLAN_MM)
        self._wait_until(lambda: host.find("sendPlanButton").enabled, "the plan can be sent")
        host.press("sendPlanButton")
        self._wait_until(lambda: "shows the plan" in host.text("reachableText"), "it is shown")
        jumpTo(host.scene, PLAN_MM)

    def _plan_procedure(self) -> None:
        host = self._host
        self._reset_scene()
        self._only("procedurePlan")
        host.choose("procedurePlanComboBox", PROCEDURE)
        host.press("editProcedureButton")
        host.press("checkLinesButton")
        said = "procedurePlanText"
        self._wait_until(lambda: "can be carried out" in host.text(said), "it is measured")
        line = load_scenario(asset_path("scenarios", "colin27")).procedure("biopsy").trajectories[0]
        jumpTo(host.scene, line.target_ras)
        host.look_at(HEAD, FROM_THE_RIGHT, ELEVATION, DISTANCE_MM)

    def _reset_scene(self) -> None:
        """Close the scene, which is full, and show the head again."""
        self._host.clear_scene()
        self._host.press("showScenarioButton")
        self._host.finish_work()

    def _carry_out_procedure(self) -> None:
        """Start the task with the procedure, and lead it until the instrument is at its target."""
        host = self._host
        self._reset_scene()
        host.check("robotCheckBox")
        host.finish_work()
        self._only("training")
        host.choose("procedureComboBox", PROCEDURE)
        self._next("Pause")
        self._only("procedure")
        self._trainee("--points", "1", "15", "--register")
        self._press_when_usable("acceptButton", "alignButton")
        host.press("alignButton")
        state = "procedureStateText"
        self._wait_until(lambda: "0.00 mm and 0.00°" in host.text(state), "it is aligned")
        host.press("lockButton")
        self._trainee("--drill")
        self._press_when_usable("startInsertionButton", "releaseButton")
        self._trainee("--insert")
        host.look_at(HEAD, FROM_THE_RIGHT, ELEVATION, DISTANCE_MM)

    def _press_when_usable(self, name: str, following: str) -> None:
        host = self._host
        for button, press in ((name, True), (following, False)):
            self._wait_until(lambda button=button: host.find(button).enabled, f"{button} is usable")
            if press:
                host.press(button)

    def _touch(self, first: int, last: int) -> None:
        self._trainee("--points", str(first), str(last), "--slip-at", str(SLIP_AT))
        bar = self._host.find("pointsProgressBar")
        self._wait_until(lambda: bar.value == last, "the touches are shown")

    def _trainee(self, *words: str) -> None:
        logic = Path(rastrainer.__file__).parents[1]
        command = [sys.executable, "-m", "Testing.slicer.real.tour_trainee", "--logic", str(logic)]
        command += ["--scenario", str(asset_path("scenarios", "colin27"))]
        command += ["--records", str(self._records)]
        command += ["--port", str(self._host.find("portSpinBox").value), *words]
        process = subprocess.Popen(command)
        self._wait_until(lambda: process.poll() is not None, "the trainee is done")
        assert process.returncode == 0

    def _next(self, until: str) -> None:
        self._host.press("nextStepButton")
        self._wait_for(until)

    def _wait_for(self, title: str) -> None:
        host = self._host
        self._wait_until(lambda: host.text("nextStepButton") == title, f"the button says {title}")

    def _wait_until(self, condition: Callable[[], Any], what: str) -> None:
        self._host.wait_until(condition, what, PATIENCE_S)

    def _only(self, shown: str) -> None:
        """Fold every section except one, as the steps do; this one need not be a step."""
        for name in SECTIONS:
            self._host.find(f"{name}CollapsibleButton").collapsed = name != shown
        self._host.process_events()

    def _take(self, name: str) -> None:
        """Save a picture."""
        self._host.idle_for(0.5)
        take(self._host, self._pictures / f"tutorial-{name}.png")


def save_all(pictures: Path) -> None:
    """Play the tutorial and save its pictures."""
    with temporary_host() as (host, temporary):
        Tutorial(host, temporary, pictures).play()


if __name__ == "__main__":
    save_all(Path(sys.argv[1]))
