"""Everything that the module holds while it is loaded: link, study, and the logic of each step."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.protocol import DECIDE, Phase, RegistrationMethod
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario, playable_methods
from rastrainer.sections.landmarks_logic import LandmarkPoints
from rastrainer.sections.new_scenario_logic import ScenarioMaker
from rastrainer.sections.procedure_logic import ProcedureLogic
from rastrainer.sections.registration_logic import RegistrationLogic
from rastrainer.sections.scenario_files import ScenarioCache, ScenarioFiles
from rastrainer.sections.scenario_logic import ScenarioLogic
from rastrainer.sections.score_logic import ReplayLogic
from rastrainer.sections.simulator_logic import SimulatorLogic
from rastrainer.sections.study_logic import StudyLogic
from rastrainer.sections.target_plan_logic import PlanLogic
from rastrainer.sections.trace_logic import TraceLogic
from rastrainer.sections.trainees_logic import CurriculumLogic, TraineeLogic
from rastrainer.sections.training_logic import TrainingLogic
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.sections.trial_services import TrialServices
from rastrainer.sections.views import BorrowedLayout, SliceFollower
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import REST_S, SOON_S, CallSoon, ConnectorKit, Link
from rastrainer.slicer.program.child_process import OwnProcess, Run
from rastrainer.slicer.program.simulator_package import SimulatorPackage
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from rastrainer.slicer.scene.scenario_nodes import SceneFileLoader
from rastrainer.slicer.scene.scene_watch import SceneWatch
from rastrainer.slicer.scene.trial_scene import followPlacement
from rastrainer.slicer.settings import Settings
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.database import (
    INTERACTIVE_WAIT_S,
    LockWait,
    PostgresAddress,
    StudyPlace,
)
from rastrainer.study.database.postgres_connecting import find_driver_in
from rastrainer.study.database.study import Study
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.ctps import PUBLISHED_STUDY, read_trials

ROBOT = Path("robots", "iiwa7")


@dataclass(frozen=True)
class ModulePaths:
    """Where the session reads and writes files.

    `python` sets the simulator up, runs it, and does long work in separate processes. `records`
    are the journals of the simulator that is started from here. In the `library` are the user's own
    scenarios.
    """

    assets: Path
    python: Path
    simulator: Path
    study: Path
    records: Path
    library: Path
    package: SimulatorPackage
    studyAddress: PostgresAddress | None = None


class ModuleSession:
    """Wires the parts together.

    `process` is to be called soon after `woken` has been emitted, and when `restS` are over.

    Attributes:
        studyPlace: where the present study is: `studyFile`, or an address.
        procedures, methods: names and titles of procedures, and names of methods of registration,
            that the chosen scenario has.
        isSeen: returns whether someone may be looking at the module, at the 3D view, or (where
            asked to count them) at the slice views; the module's widget sets it.
        scenarioMade: emits the name of a scenario that has just been made.
        woken: emits when `process` has something to do soon; perhaps from inside VTK.
        sceneChanged: emits when what the panels show of the scene may be another.
        secondPassed: emits about once a second as long as `process` is called.
    """

    def __init__(
        self,
        scene: Any,
        places: ModulePaths,
        findKit: Callable[[], ConnectorKit | None],
        settings: Settings | None = None,
        callSoon: CallSoon = lambda _work: None,
        run: Run | None = None,
    ) -> None:
        """Without `settings`, what the user chooses is forgotten at the end.

        `run` runs functions that take long, by default each in a separate process.
        """
        self.places = places
        self.settings = settings or Settings()
        self.layout = BorrowedLayout(scene)
        self.studyFile = places.study
        self.studyPlace: StudyPlace = places.studyAddress or places.study
        self._scene, self._callSoon = scene, callSoon
        self._lockWait = LockWait(*INTERACTIVE_WAIT_S)
        find_driver_in(places.simulator)
        self.scenarios = cache = ScenarioCache(places.assets / "scenarios", places.library)
        self.procedures: tuple[tuple[str, str], ...] = ()
        self.methods: tuple[str, ...] = (RegistrationMethod.FIDUCIALS.value,)
        self.cohort = read_trials(places.assets.joinpath(*PUBLISHED_STUDY))
        self.work = BackgroundWork()
        self.link = Link(scene, findKit, callSoon=callSoon)
        run = run or OwnProcess(places.python)
        setup = SimulatorSetup(places.python, places.simulator, places.package)
        self.simulator = SimulatorLogic(self.link, setup, places.records, self.settings)
        self.trainees = TraineeLogic(self.openStudy, places.records, self.openStudyPatiently)
        self.scenario = ScenarioLogic(scene, cache, places.assets / ROBOT, run, self.work)
        self.files = SceneFileLoader(scene, self.work)
        self.scenarioFiles = ScenarioFiles(self.simulator, cache, places.library)
        self.scenarioMaker = ScenarioMaker(scene, self.scenarioFiles, run)
        self.training = TrainingLogic(scene, self.link, cache.find, later=self.work.changeScene)
        self.slices = SliceFollower(scene, self.training, self.settings, later=self.work.later)
        self.study = StudyLogic(self.trainees, self.training, self.link)
        self.curriculum = CurriculumLogic(self.trainees, self.link)
        services = TrialServices(
            scene, self.link, cache.find, self.openStudyPatiently, self.work, places.records, run
        )
        self.trials = TrialLogic(services, self.cohort)
        self.procedure = ProcedureLogic(services)
        self.traces = TraceLogic(services)
        self.replay = ReplayLogic(
            services, places.assets / ROBOT, self._isTrialOpen, self.trials.isBeingScored
        )
        self.registration = RegistrationLogic(scene, self.work)
        self.plan = PlanLogic(scene, self.link, self.registration)
        self.landmarks = LandmarkPoints(scene)
        self.task = self.taskTitle = ""
        self.isSeen: Callable[[bool], bool] = lambda _inSlices: False
        self.taskChosen, self.scenarioMade = Signal(), Signal()
        self.woken, self.sceneChanged, self.secondPassed = Signal(), Signal(), Signal()
        self._second = 0
        self._watch = SceneWatch(scene)
        self._trial = ""
        self.training.sceneShown.connect(self.procedure.showPlan)
        self.training.sceneShown.connect(self.traces.begin)
        self.trials.trialScored.connect(self._takeScored)
        unscored = self.trials.abortedKept, self.trials.drillKept
        for kept in (self.trials.trialKept, *unscored):
            kept.connect(lambda trial: self.study.leadAgain(trial.trainee))
        for kept in unscored:
            kept.connect(self._showTrainees)
            kept.connect(lambda record: self.training.endDrill(record.trainee))
        self.training.changed.connect(self._noticeNewTrial)
        self.replay.shown.connect(self.registration.reset)
        self.replay.procedureShown.connect(self.procedure.showOutcome)
        own = self.simulator
        changes = [self._watch.noticed, self.link.woken, self.link.statusChanged]
        changes += [own.program.changed, own.setup.changed, own.running.changed]
        changes += [self.trainees.changed, self.trials.trialScored, self.trials.problemFound]
        for signal in changes:
            signal.connect(lambda *_values: self.woken.emit())

    def openStudy(self) -> Study:
        """Open the present study, or begin it; the window's thread waits for no lock."""
        return Study.open(self.studyPlace, self._lockWait, make_folder=True)

    def openStudyPatiently(self) -> Study:
        """Open the present study in a thread that may wait for a lock; otherwise as `openStudy`."""
        return Study.open(self.studyPlace, make_folder=True)

    def chooseStudy(self, place: StudyPlace) -> None:
        Study.open(place, self._lockWait, make_folder=True).close()
        self.study.leaveStudy()
        self.studyPlace = place
        if isinstance(place, Path):
            self.studyFile = place
        self.trials.forgetWaiting()
        self.trainees.reopen()

    def chooseTask(self, task: Task | None, scenario: Scenario) -> None:
        """Choose a task of a scenario, or the drill of decisions (None)."""
        self.task, self.taskTitle = DECIDE, _("Decide")
        if task is not None:
            self.task, self.taskTitle = task.name, task.title
        self.procedures = tuple((each.name, each.title) for each in scenario.procedures)
        self.methods = tuple(each.value for each in playable_methods(scenario))
        self.taskChosen.emit()

    def restS(self, isEntered: bool) -> float | None:
        """Return how long the next `process` may wait; None: until `woken` is emitted.

        Nothing reports what other programs write into the study, or that time has passed.
        """
        if self.simulator.isChanging or self.replay.isReleasing:
            return SOON_S
        isWatched = isEntered or self.simulator.program.isRunning
        return self.link.restS or (REST_S if isWatched else None)

    def process(self) -> None:
        """Do all due work; there is none while a scene is loaded or cleared."""
        self.simulator.process()
        if self._scene.IsBatchProcessing():
            return
        inSlices = self.slices.needsPoses
        areShown = self.scenario.isRobotShown or inSlices
        self.link.requestPoses(areShown and self.isSeen(inSlices))
        self.link.process()
        self.work.process()
        if self._lockWait.may_retry():
            # What could not be read while the study was locked may be shown now.
            self.trainees.changed.emit()
        if self.trainees.hasChangedElsewhere():
            self._showTrainees()
        self.study.process()
        self.registration.process()
        self.traces.process()
        self.replay.process()
        self.files.process()
        followPlacement(self._scene)
        self.slices.process()
        if self._watch.hasChanged:
            self._watch.hasChanged = False
            self.sceneChanged.emit()
        if self._second != int(time.monotonic()):
            self._second = int(time.monotonic())
            self.secondPassed.emit()

    def yieldTimeToWork(self) -> bool:
        """Let background work run for a moment; return whether any is left."""
        self.work.yieldTime()
        if not self._scene.IsBatchProcessing():
            self.work.process()
        return self.work.isBusy

    def sceneWasCleared(self) -> None:
        """Forget references into the old scene; a running trial is shown again."""
        # Not yet now, as Slicer shows its last layout again after a scene is closed.
        self._callSoon(self.layout.giveBack)
        shown = self.work, self.replay, self.slices, self.scenario, self.registration
        for part in (*shown, self.traces, self.training):
            part.forgetScene()

    def close(self) -> None:
        """Disconnect, close the study, and end the simulator that was started from here."""
        self._watch.close()
        self.layout.giveBack()
        listening = self.study, self.curriculum, self.procedure, self.traces, self.training
        for part in (*listening, self.trials, self.work):
            part.close()
        self.link.disconnect()
        self.trainees.close()
        self.simulator.close()

    def _isTrialOpen(self) -> bool:
        return self.link.seen.isOpen and self.training.status.isOpen

    def _showTrainees(self, *_values: Any) -> None:
        """Let each panel show the changed study in a separate turn."""
        for listener in self.trainees.changed.listeners:
            self.work.later(listener)

    def _takeScored(self, analysis: TrialAnalysis) -> None:
        record, present = analysis.record, self.training.status
        self.plan.takeTruth(analysis)
        isOtherOpen = self._isTrialOpen() and present.trialId != record.trial_id
        if analysis.procedure is not None and not isOtherOpen:
            self.procedure.showOutcome(analysis.procedure, record.procedure, analysis.truth)
        self.replay.takeFeedback(record.trial_id, analysis.feedback)
        self._showTrainees()

    def _noticeNewTrial(self) -> None:
        trial = self.training.status
        if trial.trialId != self._trial and trial.phase == Phase.RUNNING.value:
            self._trial = trial.trialId
            self.registration.reset()
            self.plan.forgetTruth()
