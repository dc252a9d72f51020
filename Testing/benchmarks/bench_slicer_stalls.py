"""How long the module keeps Slicer's window from answering: the longest stall of each step.

The host plays Slicer, whose main thread keeps Python's lock while it waits for events. What
Slicer's own views, trees and widgets then do for the module it cannot measure.
"""

import tempfile
import uuid
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.json_records import record_from_json
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.study.database.study import Study
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.assets import asset_path
from Testing.benchmarks.row import row
from Testing.domain.trial.trial_records import make_record
from Testing.end_to_end.module.installed_simulator import write_program
from Testing.slicer.head.debian_heads import COLIN27
from Testing.slicer.head.phantoms import phantom
from Testing.slicer.head.volume_file import write_volume
from Testing.slicer.host.event_loop import StallWatch
from Testing.slicer.host.host import Host
from Testing.slicer.recorded_trial import write_recorded_trial
from Testing.slicer.simulator_double import SimulatorDouble

TRAINEE, TASK, SEED = "T-001", "task-1", 3
TRIAL_S = 300.0
EARLIER_TRIALS = 40
OWN = "without waits for a CPU"
"""Priority of other programs, by which stalls can be compared on a busy machine."""
JOURNALS_DELETED = 10
SECTIONS = (
    "trainees",
    "scenario",
    "newScenario",
    "training",
    "registration",
    "score",
    "simulator",
    "study",
)


def rows(quick: bool) -> list[dict]:
    """Return the rows `stalls.*`, the longest stall of the main thread in each step."""
    longest: dict[str, list[float]] = {}
    for _ in range(1 if quick else 3):
        with tempfile.TemporaryDirectory() as folder:
            for step, seconds in _Steps(Path(folder)).measured().items():
                longest.setdefault(step, []).append(1e3 * np.array(seconds))
    return [
        row(f"stalls.{step}", of_wall, "ms", OWN, of_own)
        for step, values in longest.items()
        for of_wall, of_own in [np.transpose(values)]
    ]


class _Steps:
    """A session in which each step is watched."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._longest: dict[str, tuple[float, float]] = {}
        self._colin = load_scenario(asset_path("scenarios", "colin27"))
        self._touches = transforms.apply(
            self._colin.perturbed_head_to_world(SEED),
            self._colin.task(TASK).fiducials
            + np.random.default_rng(SEED).normal(0.0, 0.7, (len(LABELS), 3)),
        )

    def measured(self) -> dict[str, tuple[float, float]]:
        """Return the longest stall of each step, s: in all, and without waits for a processor."""
        self._host = host = Host(self._folder / "slicer")
        with SimulatorDouble(self._answer) as self._simulator:
            try:
                self._prepare()
                host.keeps_lock = True
                self._play()
                self._build()
                self._manage()
            finally:
                host.keeps_lock = False
                host.close()
        assert not host.errors, "\n".join(host.errors)
        return self._longest

    def _prepare(self) -> None:
        host = self._host
        self._watch("opening", host.open)
        for section in SECTIONS:
            host.find(f"{section}CollapsibleButton").collapsed = False
        for group in ("setupGroupBox", "adjustHeadGroupBox"):
            host.find(group).collapsed = False
        host.process_events()
        self._trial = self._record(1000)
        self._write_journal(self._trial["trialId"])
        self._store(Path(host.find("studyPathLineEdit").currentPath), EARLIER_TRIALS)
        host.press("createTraineeButton")
        host.choose("traineeComboBox", TRAINEE)
        program = write_program(self._folder / "rastrainer", self._folder / "pid", [])
        host.type("programPathLineEdit", str(program))
        host.type("portSpinBox", str(self._simulator.port))
        self._watch("connect", self._connect)

    def _connect(self) -> None:
        self._host.press("connectButton")
        self._host.wait_until(lambda: self._simulator.commands, "it is connected")

    def _play(self) -> None:
        host = self._host
        self._watch("show_scenario", lambda: host.press("showScenarioButton"))
        place = self._colin.target.position_ras + 10.0
        slices = host.widget.logic.session.slices
        self._watch("next_point", lambda: slices.show(place))
        self._watch("show_robot", lambda: host.check("robotCheckBox"))
        host.check("robotCheckBox", False)
        self._watch("trial", self._touch)
        self._watch("scoring", self._score)
        self._watch("replay", lambda: host.press("replayButton"))
        self._watch("worst_touch", lambda: host.press("worstTouchButton"))
        host.check("consentCheckBox")
        host.answer("Export all trials", self._folder / "trials.csv")
        self._watch("export", lambda: host.press("exportScoresButton"))
        host.answer("Folder for the report", self._folder / "report")
        self._watch("report", lambda: host.press("reportButton"))

    def _touch(self) -> None:
        for count in range(1, len(LABELS) + 1):
            setPoints(
                Role.CAPTURED_POINTS.make(self._host.scene), LABELS[:count], self._touches[:count]
            )
            self._host.idle_for(0.3)

    def _score(self) -> None:
        self._simulator.send_command("TrialCompleted", self._trial)
        host = self._host
        host.wait_until(
            lambda: host.find("historyTable").rowCount == EARLIER_TRIALS + 1, "it is in the history"
        )
        host.wait_until(lambda: "LC-CUSUM" in host.text("feedbackText"), "the feedback is shown")
        host.press("learningCurveButton")

    def _build(self) -> None:
        host = self._host
        path = self._volume()
        node = host.scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Head")
        storage = host.scene.AddNewNodeByClass("vtkMRMLVolumeArchetypeStorageNode")
        storage.SetFileName(str(path))
        assert storage.ReadData(node)
        host.choose("scanComboBox", node)
        self._watch("preview", lambda: host.press("previewHeadButton"))
        self._watch("building", lambda: host.press("makeScenarioButton"))

    def _manage(self) -> None:
        host = self._host
        self._watch("close_scene", host.clear_scene)
        for number in range(JOURNALS_DELETED - 1):
            self._write_journal(str(uuid.UUID(int=number + 1)))
        host.answer("cannot be undone", "Yes")
        self._watch("delete_trainee", lambda: host.press("deleteTraineeButton"))

    def _store(self, path: Path, count: int) -> None:
        """Store trials in a study: one registration serves for all."""
        with Study.open(path) as study:
            analysis = analyze_trial(record_from_json(TrialRecord, self._record(0)), self._colin)
            fits, errors = analysis.fits.values(), analysis.target_errors
            for number in range(count):
                record = {**self._record(number), "trainee": TRAINEE}
                study.add_trial(record, fits, errors, analysis.score)
                study.add_results(
                    record["trialId"], truth=RevealedTruth(tuple(np.eye(4).ravel().tolist()), 1.0)
                )

    def _write_journal(self, trial_id: str) -> None:
        folder = Path.home() / "RASTrainer" / "trials"
        write_recorded_trial(folder, trial_id, TRIAL_S, TRAINEE, touch_every_s=20)

    def _volume(self) -> Path:
        """Return Colin's head as it came from the scanner, or a phantom where it is not here."""
        if COLIN27.is_file():
            return COLIN27
        scan = phantom(spacing=(1.0, 1.0, 1.2), noise=2.0)
        return write_volume(self._folder / "head.nrrd", scan)

    def _watch(self, step: str, work: Callable[[], object]) -> None:
        with StallWatch() as watch:
            work()
            self._host.finish_work()
            self._host.idle_for(0.5)
        self._longest[step] = watch.longest_s, watch.longest_own_s
        for stall in sorted(watch.stalls, key=lambda stall: -stall.own_s)[:3]:
            times = f"{1e3 * stall.seconds:.0f} ms, {1e3 * stall.own_s:.0f} of its own"
            print(f"    {step}: {times}  {stall.ran}")

    def _answer(self, name: str, arguments: dict) -> dict:
        if name != "SubmitRegistration":
            return {}
        head_to_world = self._colin.perturbed_head_to_world(SEED)
        target = self._colin.target.position_ras
        found = np.reshape(arguments["matrix"], (4, 4)) @ head_to_world
        error = float(np.linalg.norm(transforms.apply(found, target) - target))
        return {"headToWorld": head_to_world.ravel().tolist(), "trueTreMm": error}

    def _record(self, number: int) -> dict:
        points = [
            {**point, "positionMm": position.tolist()}
            for point, position in zip(make_record()["points"], self._touches, strict=True)
        ]
        return make_record(
            trialId=str(uuid.UUID(int=number + 1)),
            startedUtc=f"2026-03-02T{9 + number // 3600:02d}:{number // 60 % 60:02d}:00Z",
            completedUtc="2026-03-02T12:00:20Z",
            points=points,
            touchRule="on skin",
            motion=dict.fromkeys(SAFETY_METRICS, 0.0),
        )
