"""Everything that the module keeps while it is loaded: link, study, and a desk for each step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.protocol import Phase
from rastrainer.slicer.connector_kit import ConnectorKit
from rastrainer.slicer.link import Link
from rastrainer.slicer.plan_desk import PlanDesk
from rastrainer.slicer.registration_desk import RegistrationDesk
from rastrainer.slicer.replay_desk import ReplayDesk
from rastrainer.slicer.scenario_desk import ScenarioDesk
from rastrainer.slicer.scenario_files import ScenarioFiles
from rastrainer.slicer.scenario_maker import ScenarioMaker
from rastrainer.slicer.scenario_shelf import ScenarioShelf
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.simulator_desk import SimulatorDesk
from rastrainer.slicer.simulator_setup import SimulatorSetup
from rastrainer.slicer.study_desk import StudyDesk
from rastrainer.slicer.study_place import openStudyFile
from rastrainer.slicer.trainee_desk import TraineeDesk
from rastrainer.slicer.training_desk import TrainingDesk
from rastrainer.slicer.trial_desk import ScoredTrial, TrialDesk
from rastrainer.slicer.world_placement import followPlacement
from rastrainer.study import Study
from rastrainer.trial_files import read_trials

ROBOT = Path("robots", "iiwa7")
PUBLISHED_STUDY = Path("studies", "published.csv")


@dataclass(frozen=True)
class Places:
    """Where the session finds and puts things.

    Attributes:
        assets: folder of scenarios, robots and published studies.
        python: that sets the simulator up and runs it.
        simulator: private folder of the simulator.
        study: file of the study, until another is chosen.
        records: folder of the journals of the simulator that is started from here.
        library: folder of the user's own scenarios, which the simulator knows too.
        package: what pip installs, unless the user says otherwise.
    """

    assets: Path
    python: Path
    simulator: Path
    study: Path
    records: Path
    library: Path
    package: str


class Session:
    """Wires the desks together; `process` is to be called about ten times a second.

    Attributes:
        link: to the simulator.
        simulator: its set-up and process.
        trainees: who trains.
        scenario: head, tasks and robot in the scene.
        scenarioMaker: makes scenarios of volumes.
        scenarioFiles: takes and gives scenarios as files, and keeps plans in them.
        training: trials under way.
        study: leads through the protocol.
        trials: where finished trials arrive.
        replay: feedback on stored trials, and their replay.
        registration: that is looked at.
        plan: of a target.
        cohort: trials of the published study, with which CTPS compares.
        studyPath: file of the present study.
        task: name of the chosen task.
        taskTitle: what people read.
        taskChosen: emits nothing, whenever another task is chosen.
        scenarioMade: emits the name of a scenario that has just been made.
    """

    def __init__(
        self, scene: Any, places: Places, findKit: Callable[[], ConnectorKit | None]
    ) -> None:
        self.places = places
        self.studyPath = places.study
        self._scene = scene
        shelf = ScenarioShelf.below(places.assets / "scenarios", places.library)
        self.cohort = read_trials(places.assets / PUBLISHED_STUDY)
        self.link = Link(scene, findKit)
        setup = SimulatorSetup(places.python, places.simulator)
        self.simulator = SimulatorDesk(self.link, setup, places.records)
        self.trainees = TraineeDesk(self.openStudy, places.records)
        self.scenario = ScenarioDesk(scene, shelf, places.assets / ROBOT)
        self.scenarioMaker = ScenarioMaker(scene, self.simulator, shelf, places.library)
        self.scenarioFiles = ScenarioFiles(self.simulator, shelf, places.library)
        self.training = TrainingDesk(scene, self.link, shelf.find)
        self.study = StudyDesk(self.trainees, self.training, self.link)
        self.trials = TrialDesk(
            scene, self.link, shelf.find, self.openStudy, self.cohort, places.records
        )
        self.replay = ReplayDesk(
            scene, self.trainees, shelf.find, places.records, places.assets / ROBOT
        )
        self.registration = RegistrationDesk(scene)
        self.plan = PlanDesk(scene, self.link, self.registration)
        self.task = ""
        self.taskTitle = ""
        self.taskChosen = Signal()
        self.scenarioMade = Signal()
        self._trial = ""
        self.trials.trialKept.connect(self.study.countTrial)
        self.trials.trialScored.connect(self._takeScored)
        self.link.stateChanged.connect(self._noticeNewTrial)

    def openStudy(self) -> Study:
        """Open the present study, or begin it.

        Raises:
            InputError: the file is no study, or cannot be used.
        """
        return openStudyFile(self.studyPath)

    def chooseStudy(self, path: Path) -> None:
        """Go on with the study of another file, which is begun where there is none.

        Raises:
            InputError: the file is no study, or cannot be used; the present one stays.
        """
        openStudyFile(path).close()
        self.studyPath = path
        self.trials.closeStudy()
        self.trainees.reopen()

    def chooseTask(self, name: str, title: str) -> None:
        """Choose the task that is started next."""
        self.task, self.taskTitle = name, title
        self.taskChosen.emit()

    def process(self) -> None:
        """Do what is due; while a scene is loaded or cleared, nothing is."""
        self.simulator.process()
        if self._scene.IsBatchProcessing():
            return
        self.link.process()
        self.study.process()
        self.registration.process()
        self.replay.process()
        followPlacement(self._scene)

    def sceneWasCleared(self) -> None:
        """Forget what pointed into the old scene; a trial that runs is shown again."""
        self.registration.reset()
        self.training.forgetScene()

    def close(self) -> None:
        """Disconnect, close the study, and end the simulator that was started from here."""
        self.study.close()
        self.training.close()
        self.trials.close()
        self.link.disconnect()
        self.trainees.close()
        self.simulator.close()

    def _takeScored(self, trial: ScoredTrial) -> None:
        self.plan.takeTruth(trial)
        self.trainees.changed.emit()

    def _noticeNewTrial(self, state: dict[str, Any]) -> None:
        trial = str(state.get("trialId", ""))
        if trial != self._trial and state.get("phase") == Phase.RUNNING.value:
            self._trial = trial
            self.registration.reset()
            self.plan.forgetTruth()
