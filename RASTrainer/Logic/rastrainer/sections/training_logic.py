"""Starts and controls trials from Slicer, and shows the state and the scene of the open trial."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any, TypeVar, cast

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.json_checks import is_number
from rastrainer.protocol import (
    DECIDE,
    FIDUCIAL_COUNT,
    OPEN_PHASES,
    PROCEDURE_PHASES,
    TRIAL_RUN,
    Phase,
    RegistrationMethod,
)
from rastrainer.scenario.scenario import Scenario, method_of
from rastrainer.sections.trainees_logic import NOBODY
from rastrainer.slicer.background_work import CallLater, callNow
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.scenario_nodes import showScenario, showTask
from rastrainer.slicer.scene.trial_scene import (
    forgetStoredTouches,
    noteTouchedTask,
    showPlannedPlace,
)
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _

LOADING = _("The simulator is still loading a scenario: wait until it says that it uses it.")
LOADING_S = 30.0
"""How long the simulator may take to load a scenario."""


T = TypeVar("T")


@dataclass(frozen=True)
class ProcedureStatus:
    """State of the trial's procedure, everything by the registration in use.

    The `name` is empty without a procedure; its lines (`trajectory`) are counted from 0. The guide
    is `entryDistanceMm` and `angleDeg` off the planned line, and its tip is `standOffMm` before the
    entry; drill or instrument is `feedMm` beyond the tip.
    """

    name: str = ""
    trajectory: int = 0
    trajectories: int = 0
    registrationInUse: bool = False
    entryDistanceMm: float | None = None
    angleDeg: float | None = None
    standOffMm: float | None = None
    feedMm: float = 0.0
    lastCheckMm: float | None = None


@dataclass(frozen=True)
class TraceStatus:
    """State of the trace over the skin: the number of its points, and whether it is being drawn."""

    kept: int = 0
    strokes: int = 0
    on: bool = False
    isGuided: bool = False


@dataclass(frozen=True)
class TrialStatus:
    """State of the simulator's trial; without one, its phase is `idle`.

    `touched` of `total` points are kept; the trainee reads `instruction`.
    """

    trialId: str = ""
    phase: str = Phase.IDLE.value
    trainee: str = ""
    task: str = ""
    mode: str = ""
    nextPoint: str = ""
    touched: int = 0
    total: int = FIDUCIAL_COUNT
    elapsedS: float = 0.0
    proximity: str = ""
    instruction: str = ""
    method: str = RegistrationMethod.FIDUCIALS.value
    procedure: ProcedureStatus = field(default_factory=ProcedureStatus)
    trace: TraceStatus | None = None

    @property
    def isOpen(self) -> bool:
        """Whether a trial is being played, paused, or waits to be registered."""
        return self.phase in OPEN_PHASES

    @property
    def isProcedureUnderWay(self) -> bool:
        return bool(self.procedure.name) and self.phase in PROCEDURE_PHASES


def readStatus(state: Mapping[str, Any]) -> TrialStatus:
    """Return what a message about the trial says; values of the wrong kind count as missing."""
    trace = state.get("trace")
    return replace(
        _known(TrialStatus, state),
        procedure=_known(ProcedureStatus, state.get("procedure")),
        trace=_known(TraceStatus, trace) if isinstance(trace, Mapping) else None,
    )


def _known(kind: type[T], given: Any) -> T:
    """Return the texts, truth values and numbers of a peer that have their field's kind."""
    values: dict[str, Any] = {}
    for each in fields(cast(Any, kind)):
        value: Any = given.get(each.name) if isinstance(given, Mapping) else None
        if str(each.type).startswith(("int", "float")) and is_number(value):
            values[each.name] = int(value) if each.type == "int" else float(value)
        elif each.type in ("str", "bool") and type(value).__name__ == each.type:
            values[each.name] = value
    return kind(**values)


class TrainingLogic(Listening):
    """Work of the section Training; answers come by a later `process` of the link.

    Attributes:
        changed: emits nothing, whenever `status` has changed in more than its time.
        answered: emits the error of each command, empty if it was accepted.
        sceneShown: emits the `Scenario` of an open trial whose head and fiducials are now shown.
        learner: the trainee doing the tutorial before the trial run; empty if none.
        decider: the trainee whose drill was started from here and has not arrived; empty if none.
        loadings: how many scenarios the simulator is loading for Slicer; it refuses trials then.
    """

    def __init__(
        self,
        scene: Any,
        link: Link,
        findScenario: Callable[[str], Scenario],
        clock: Callable[[], float] = time.monotonic,
        later: CallLater = callNow,
    ) -> None:
        """`later` changes the scene, one part after the other."""
        self.changed, self.answered, self.sceneShown = Signal(), Signal(), Signal()
        self.learner = self.decider = ""
        self._scene, self._link, self._findScenario = scene, link, findScenario
        self._clock, self._later = clock, later
        self._said, self._saidAt = TrialStatus(), 0.0
        self._shownTrial = ""
        self._total = FIDUCIAL_COUNT
        self.loadings = 0
        super().__init__(
            (link.stateChanged, self._follow),
            (link.pointsChanged, lambda _node: self.changed.emit()),
        )

    @property
    def status(self) -> TrialStatus:
        """State of the trial now; its time continues between two messages."""
        said, elapsed = self._said, self._said.elapsedS
        if said.phase == Phase.RUNNING.value:
            elapsed += self._clock() - self._saidAt
        touches = Role.CAPTURED_POINTS.find(self._scene)
        touched = touches.GetNumberOfControlPoints() if said.trialId and touches else 0
        return replace(said, touched=touched, total=self._total, elapsedS=elapsed)

    def start(
        self,
        trainee: str,
        task: str,
        mode: str,
        isTutorialFirst: bool = False,
        **others: str | Mapping[str, float],
    ) -> None:
        """Start a drill, or a trial, by fiducials and with no procedure unless `others` names them.

        Its skin shifts by the `skin` there, or as the scenario says. With `isTutorialFirst`, the
        simulator may open the tutorial instead of a trial run, which can be started after it.
        """
        if not trainee:
            raise InputError(NOBODY)
        if not task:
            raise InputError(_("Choose a task first."))
        who = {"trainee": trainee, "mode": mode}
        if task == DECIDE:
            self._link.send(
                CommandName.START_DRILL, who, lambda reply: self._noteDrill(reply, trainee)
            )
        elif task == TRIAL_RUN and isTutorialFirst:
            self._link.send(
                CommandName.START_TUTORIAL, who, lambda reply: self._startUnlessTutorial(reply, who)
            )
        else:
            if others.get("method") == RegistrationMethod.FIDUCIALS.value:
                del others["method"]
            given = {key: each for key, each in others.items() if each}
            self.command(CommandName.START_TASK, {"task": task, **who, **given})

    def command(self, name: str, arguments: Mapping[str, Any] | None = None) -> None:
        self._link.send(name, arguments, lambda reply: self.answered.emit(reply.error))

    def abort(self, trialId: str) -> None:
        if self.status.trialId != trialId:
            raise InputError(_("This trial is over. The trial that is open now was not aborted."))
        self.command(CommandName.ABORT, {"trialId": trialId})

    @property
    def obstacle(self) -> str:
        """Why no trial can be started now, for any trainee; empty if one can."""
        if not self._link.status.isConnected:
            return _("Connect to the simulator first.")
        if self.status.isOpen:
            return _("A trial is open: abort it or let it be registered first.")
        return LOADING if self.loadings else ""

    def loadScenario(self, folder: str, done: Callable[[], None]) -> None:
        """Load another scenario into the simulator, between two trials; call `done` once it has."""

        def takeAnswer(reply: Reply) -> None:
            self.loadings -= 1
            self.answered.emit(reply.error)
            if reply.ok:
                done()
            self.changed.emit()

        self.loadings += 1
        self.changed.emit()
        self._link.send(
            CommandName.LOAD_SCENARIO, {"folder": folder}, takeAnswer, timeoutS=LOADING_S
        )

    def _startUnlessTutorial(self, reply: Reply, who: Mapping[str, str]) -> None:
        """Start the trial run, unless the simulator has opened the tutorial before it."""
        if not reply.ok:
            self.answered.emit(reply.error)
        elif reply.data.get("isNeeded") is True:
            self.learner = who["trainee"]
            self.answered.emit(tutorialSentence(self.learner))
            self.changed.emit()
        else:
            self.command(CommandName.START_TASK, {"task": TRIAL_RUN, **who})

    def _noteDrill(self, reply: Reply, trainee: str) -> None:
        if reply.ok:
            self.decider = trainee
        self.answered.emit(reply.error)
        self.changed.emit()

    def endDrill(self, trainee: str) -> None:
        if self.decider == trainee:
            self.decider = ""
            self.changed.emit()

    def _follow(self, state: Mapping[str, Any]) -> None:
        before = replace(self.status, elapsedS=0.0)
        self._said, self._saidAt = readStatus(state), self._clock()
        self._showScene()
        if before != replace(self.status, elapsedS=0.0):
            self.changed.emit()

    def forgetScene(self) -> None:
        self._shownTrial = ""
        self._showScene()
        self.changed.emit()

    def _showScene(self) -> None:
        """Have the scene of the open trial shown, unless it is."""
        if self._said.isOpen:
            self.learner = self.decider = ""
            if self._said.trialId != self._shownTrial:
                self._shownTrial = self._said.trialId
                forgetStoredTouches(self._scene)
                self._link.send(CommandName.LIST_TASKS, {}, self._showTrialScene)

    def _showTrialScene(self, reply: Reply) -> None:
        """Show head and fiducials of the trial that runs, so that touches appear on them."""
        if not self._said.isOpen:
            return
        if not reply.ok:
            self._shownTrial = ""
            return
        try:
            scenario = self._findScenario(str(reply.data.get("scenario", "")))
            task, method = self._said.task, method_of(self._said.method)
        except InputError as error:
            self.answered.emit(str(error))
            return
        showScenario(self._scene, scenario, self._later)
        self._later(partial(self._showTask, scenario, task, method))

    def _showTask(self, scenario: Scenario, task: str, method: RegistrationMethod) -> None:
        try:
            fixed = showTask(self._scene, scenario, task, method)
        except InputError as error:
            self.answered.emit(str(error))
            return
        self._total = fixed.GetNumberOfControlPoints()
        noteTouchedTask(self._scene, scenario.name, task, method)
        showPlannedPlace(self._scene, scenario, fixed)
        self.sceneShown.emit(scenario)
        self.changed.emit()


def tutorialSentence(trainee: str) -> str:
    return _(
        "{trainee} does the tutorial first, at the simulator: about two minutes. Then start the "
        "trial run here, or let the trainee start it."
    ).format(trainee=trainee)
