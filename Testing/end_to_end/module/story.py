"""A whole session in the module, by buttons alone, with the real simulator's process."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from pathlib import Path

from rastrainer.slicer.link.link import CONNECTOR_NAME
from Testing.end_to_end.module.installed_simulator import bundled_package, write_program
from Testing.end_to_end.module.player import Player
from Testing.free_port import free_port
from Testing.running_process import runs
from Testing.slicer.host.host import Host

TRAINEE = "T-007"
PLAN_MM = (10.0, 20.0, 30.0)
FAST = ("--speed", "10", "--no-views", "--no-gamepad")


class Story:
    """The steps of a session, in order; each presses buttons and waits for their effect."""

    def __init__(self, host: Host, folder: Path, options: Sequence[str] = FAST) -> None:
        self.host = host
        self.folder = folder
        # Where the module looks for the journals of its simulator.
        self.records = Path.home() / "RASTrainer" / "trials"
        self.program = folder / "rastrainer"
        self._pid_file = folder / "simulator.pid"
        self._options = [*options, "--records", str(self.records)]
        self.player: Player | None = None
        self.port = 0

    def set_up(self) -> None:
        host = self.host
        setup = host.open().logic.session.simulator.setup
        setup.package = bundled_package(self.folder / "module", self._pid_file, self._options)
        host.press("setupButton")
        host.wait_until(lambda: "is set up in" in host.text("setupText"), "it is set up")

    def choose_own_program(self) -> None:
        """Use a simulator that is installed elsewhere, which is quicker than setting it up."""
        host = self.host
        self.write_program()
        host.open()
        host.find("setupGroupBox").collapsed = False
        host.type("programPathLineEdit", str(self.program))
        host.find("setupGroupBox").collapsed = True

    def write_program(self) -> None:
        """Install a simulator elsewhere."""
        write_program(self.program, self._pid_file, self._options)

    def start_simulator(self) -> None:
        host = self.host
        if self.port == 0:
            self.port = free_port()
            host.type("portSpinBox", str(self.port))
        host.press("startSimulatorButton")
        self.wait_until_connected()
        wanted = "computes the robot's kinematics"
        host.wait_until(lambda: wanted in host.text("programText"), "the kinematics are named")

    def create_trainee(self) -> None:
        host = self.host
        host.type("pseudonymLineEdit", TRAINEE)
        host.check("newConsentCheckBox")
        host.press("createTraineeButton")
        assert TRAINEE in host.find("traineeComboBox").currentText

    def show_scenario(self) -> None:
        host = self.host
        host.choose("taskComboBox", "Task 1")
        host.press("showScenarioButton")
        host.check("robotCheckBox")
        host.finish_work()
        assert host.scene.GetFirstNodeByName("Robot link 7") is not None
        # The MRI follows once the head is shown.
        volumes = "vtkMRMLScalarVolumeNode"
        host.wait_until(lambda: host.scene.GetFirstNodeByClass(volumes) is not None, "the MRI")

    def use_scenario_in_simulator(self) -> None:
        host = self.host
        host.press("loadScenarioButton")
        host.wait_until(lambda: " now uses " in host.text("scenarioText"), "the scenario is loaded")
        self.wait_until_connected()

    def abort_a_trial_run(self) -> None:
        host = self.host
        host.choose("modeComboBox", "Headset")
        host.choose("modeComboBox", "Desktop")
        host.press("startTrialRunButton")
        self._wait_for_phase("running")
        host.answer("Abort the trial", "No")
        host.press("abortButton")
        assert "running" in host.text("phaseText")
        host.answer("Abort the trial", "Yes")
        host.press("abortButton")
        host.wait_until(lambda: host.find("startTaskButton").enabled, "no trial is open")

    def start_task(self) -> None:
        self.host.press("startTaskButton")
        self._wait_for_phase("running")
        self.player = Player(self.port, self.records)

    def resume_task(self) -> None:
        """Resume the trial that the simulator has reloaded after its crash."""
        self._wait_for_phase("paused")
        self.host.press("pauseButton")
        self._wait_for_phase("running")
        self.player = Player(self.port, self.records)

    def touch_some(self) -> None:
        self.touch(1, 6)

    def pause_and_resume(self) -> None:
        for phase in ("paused", "running"):
            self.host.press("pauseButton")
            self._wait_for_phase(phase)

    def touch_the_others(self) -> None:
        self.touch(7, 15)

    def register(self) -> None:
        host = self.host
        self.player.register()
        host.wait_until(lambda: self.player.is_done, "the trainee registers")
        host.wait_until(lambda: host.find("historyTable").rowCount == 1, "the history grows")
        host.wait_until(lambda: host.find("scoreTable").rowCount > 0, "the trial is scored")

    def look_at_registration(self) -> None:
        host = self.host
        unfold(host, "registrationCollapsibleButton")
        host.wait_until(lambda: host.find("residualsTable").rowCount == 15, "15 residuals")
        host.choose("residualsTable", 3)
        host.press("excludeButton")
        host.wait_until(lambda: host.find("residualsTable").rowCount == 14, "one point is left out")
        host.press("undoButton")
        host.wait_until(lambda: host.find("residualsTable").rowCount == 15, "all points are back")
        host.choose("kindComboBox", "Affine")
        host.choose("kindComboBox", "Rigid")
        host.check("headColoredCheckBox")

    def plan_a_target(self) -> None:
        host = self.host
        unfold(host, "planCollapsibleButton")
        host.press("placeTargetButton")
        host.place(*PLAN_MM)
        host.wait_until(lambda: host.find("sendPlanButton").enabled, "the plan can be sent")
        host.press("sendPlanButton")
        host.wait_until(lambda: "shows the plan" in host.text("reachableText"), "it is shown")

    def look_at_score(self) -> None:
        host = self.host
        unfold(host, "scoreCollapsibleButton")
        host.press("showTablesButton")
        host.press("learningCurveButton")
        assert host.scene.GetFirstNodeByClass("vtkMRMLPlotChartNode") is not None
        host.wait_until(lambda: "LC-CUSUM" in host.text("feedbackText"), "the feedback is shown")
        host.press("replayButton")
        replay = host.scene.GetFirstNodeByName(f"Replay of {TRAINEE}, task-1")
        assert replay.GetNumberOfItems() > 100
        host.press("worstTouchButton")
        host.wait_until(lambda: "clearance" in host.text("replayText"), "the replay is described")

    def export(self) -> None:
        host = self.host
        for button, part, name in (
            ("exportTraineeButton", "Export the trainee", "trainee.json"),
            ("exportHistoryButton", "Export the history", "history.csv"),
            ("exportScoresButton", "Export all trials", "trials.csv"),
        ):
            host.answer(part, self.folder / name)
            host.press(button)
            assert TRAINEE in (self.folder / name).read_text(encoding="utf-8")

    def write_report(self) -> None:
        host = self.host
        host.answer("Folder for the report", self.folder / "report")
        host.press("reportButton")
        assert TRAINEE in (self.folder / "report" / "report.html").read_text(encoding="utf-8")

    def delete_trainee(self) -> None:
        host = self.host
        host.answer("cannot be undone", "No")
        host.press("deleteTraineeButton")
        assert TRAINEE in host.find("traineeComboBox").currentText
        host.answer("cannot be undone", "Yes")
        host.press("deleteTraineeButton")
        assert TRAINEE not in host.find("traineeComboBox").currentText
        assert host.find("historyTable").rowCount == 0
        assert list(self.records.glob("*.journal")) == []

    def stop_simulator(self) -> None:
        host = self.host
        host.press("stopSimulatorButton")
        # A quick one has ended by the time of this check.
        assert host.text("programText") in (
            "The simulator is ending.",
            "The simulator was stopped.",
        )
        assert host.text("stateText") == "Not connected."
        host.wait_until(lambda: "was stopped" in host.text("programText"), "it has ended")
        pid = int(self._pid_file.read_text())
        host.wait_until(lambda: not runs(pid), "its process is gone")

    STEPS = (
        set_up,
        start_simulator,
        create_trainee,
        show_scenario,
        use_scenario_in_simulator,
        abort_a_trial_run,
        start_task,
        touch_some,
        pause_and_resume,
        touch_the_others,
        register,
        look_at_registration,
        plan_a_target,
        look_at_score,
        export,
        write_report,
        delete_trainee,
        stop_simulator,
    )

    def wait_until_connected(self) -> None:
        host = self.host

        def is_connected() -> bool:
            said = host.find("simulatorLogEdit").plainText
            text = host.text("programText")
            assert "ended by itself" not in text, said
            assert "stopped unexpectedly" not in text, said
            # After a scene is cleared, the panel notices the loss at its next update.
            is_in_scene = host.scene.GetFirstNodeByName(CONNECTOR_NAME) is not None
            return is_in_scene and host.text("stateText").startswith("Connected")

        host.wait_until(is_connected, "it is connected")

    def kill_simulator(self) -> None:
        """End the simulator's process as a crash would; the module notices it."""
        host = self.host
        os.kill(int(self._pid_file.read_text()), signal.SIGKILL)
        host.wait_until(
            lambda: "stopped unexpectedly" in host.text("programText"), "its end is shown"
        )
        host.wait_until(
            lambda: not host.text("stateText").startswith("Connected"), "the link is closed, too"
        )

    def _wait_for_phase(self, words: str) -> None:
        self.host.wait_until(lambda: words in self.host.text("phaseText"), f"the trial: {words}")

    def touch(self, first: int, last: int) -> None:
        host = self.host
        self.player.touch(first, last)
        host.wait_until(lambda: self.player.is_done, f"points {first} to {last} are touched")
        host.wait_until(lambda: host.find("pointsProgressBar").value == last, "they appear")


def unfold(host: Host, name: str) -> None:
    """Unfold a section."""
    host.find(name).collapsed = False
    host.process_events()
