"""The line at the top: the state of the link, who trains what, and the one thing to do now."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from typing import Any

import qt

from rastrainer.errors import InputError
from rastrainer.panels.panel import Panel
from rastrainer.panels.plain_text import buttonTitle, shortName
from rastrainer.panels.widgets import (
    LINK_COLORS,
    connectAsPressed,
    setLight,
    setText,
    setUsable,
)
from rastrainer.protocol import OPEN_PHASES, TRIAL_RUN, Phase
from rastrainer.slicer.link.link_status import LinkState, notInstalled
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.logic.next_step import NextAction, NextStep, Section, WorkflowState, nextStep
from rastrainer.slicer.translation import _
from rastrainer.study.protocol.steps import instruction
from rastrainer.trial.analysis import TrialAnalysis


class SectionFolding:
    """Folds and opens sections whenever the workflow moves to another one, and only then.

    What the user opens or folds stays so until then. Sections without a next step, such as
    Scenario and Plan, are never changed.
    """

    def __init__(self, ui: Any) -> None:
        self._sections = {each: getattr(ui, f"{each.value}CollapsibleButton") for each in Section}
        self._present: Section | None = None

    def follow(self, section: Section) -> None:
        """Open the section of the present step; fold the others where it is another one."""
        if section is self._present:
            return
        self._present = section
        for each, button in self._sections.items():
            button.collapsed = each is not section

    def open(self, section: Section) -> None:
        self._sections[section].collapsed = False


SHORTCUT = "Ctrl+Return"
THIS_COMPUTER = ("", "127.0.0.1", "localhost", "::1")
WORDS = {
    LinkState.OFF: _("Not connected"),
    LinkState.NOT_INSTALLED: _("Not installed"),
    LinkState.LOOKING: _("Looking"),
    LinkState.ABSENT: _("No answer"),
    LinkState.OTHER_PROGRAM: _("No simulator"),
    LinkState.GREETING: _("Connecting"),
    LinkState.CONNECTED: _("Connected"),
    LinkState.STALE: _("Silent"),
    LinkState.WRONG_VERSION: _("Wrong version"),
}


class NextStepPanel(Panel):
    """Leads through a session: it draws what `nextStep` says, and lets the sections do it."""

    def __init__(
        self, ui: Any, session: ModuleSession, actions: Mapping[NextAction, Callable[[], None]]
    ) -> None:
        """`actions` does what belongs to a section: everything but waiting and viewing."""
        super().__init__(ui, session)
        self._actions = actions
        self._folding = SectionFolding(ui)
        self._step: NextStep | None = None
        self._trainee = ""
        self._hasTrainees = self._hasPracticed = False
        self._isUnscored = self._hasNewResult = self._isResultShown = False
        self._studyStep: Any = None
        self._repeatSentence = ""
        self._isSetUp = session.simulator.setup.isCurrent
        connectAsPressed(ui.nextStepButton, self._action)
        ui.hostLineEdit.connect("textChanged(QString)", self.showState)
        ui.programPathLineEdit.connect("currentPathChanged(QString)", self.showState)
        ui.scoreCollapsibleButton.connect("contentsCollapsed(bool)", self._noteScoreSeen)
        self.listen(
            (session.link.statusChanged, self.showState),
            (session.link.stateChanged, self._followTrial),
            (session.training.changed, self.showState),
            (session.taskChosen, self.showState),
            (session.simulator.program.changed, self.showState),
            (session.simulator.setup.changed, self._lookAtSetup),
            (session.simulator.setup.finished, self._lookAtSetup),
            (session.simulator.running.changed, self.showState),
            (session.trainees.changed, self._lookUp),
            (session.study.changed, self._lookUp),
            (session.trials.trialScored, self._takeResult),
            (session.trials.problemFound, self._noteProblem),
        )
        self._lookUp()

    def _action(self) -> Callable[[], None]:
        action = NextAction.WAIT if self._step is None else self._step.action
        return lambda: self._do(action)

    def _do(self, action: NextAction) -> None:
        if action in self._actions:
            self._actions[action]()
        elif action is NextAction.CHOOSE_TRAINEE:
            self._folding.open(Section.TRAINEES)
            self._ui.traineeComboBox.showPopup()
        elif action is NextAction.ANSWER:
            self._folding.open(Section.STUDY)
        elif action is NextAction.SHOW_RESULT:
            self._hasNewResult, self._isResultShown = False, True
        self.showState()

    def showState(self, *_arguments: Any) -> None:
        now = self._situation()
        self._step = nextStep(now)
        self._show(now, self._step)

    def _situation(self) -> WorkflowState:
        session, ui = self._session, self._ui
        simulator, trial, study = session.simulator, session.training.status, self._studyStep
        return WorkflowState(
            # Reported at once, before downloading a simulator to which no connection is possible.
            link=session.link.status if session.link.findKit() else notInstalled(),
            program=simulator.program.state,
            programSentence=simulator.program.sentence,
            needsSetup=not (self._isSetUp or simulator.ownProgram),
            isBeingSetUp=simulator.setup.isRunning,
            isElsewhere=ui.hostLineEdit.text.strip() not in THIS_COMPUTER,
            runningSentence=simulator.running.sentence if simulator.running.canConnect else "",
            trainee=self._trainee,
            hasTrainees=self._hasTrainees,
            hasPracticed=self._hasPracticed,
            isLearning=bool(self._trainee) and session.training.learner == self._trainee,
            taskTitle=session.taskTitle,
            phase=trial.phase,
            touched=trial.touched,
            total=trial.total,
            isLoading=session.training.isLoading,
            isUnscored=self._isUnscored,
            hasNewResult=self._hasNewResult,
            isResultShown=self._isResultShown,
            studyStep=None if study is None else study.kind,
            needsRepeatReason=bool(self._repeatSentence),
            studySentence=self._repeatSentence or ("" if study is None else instruction(study)),
        )

    def _show(self, now: WorkflowState, step: NextStep) -> None:
        ui = self._ui
        setLight(ui.linkLight, LINK_COLORS[now.link.state])
        setText(ui.linkText, WORDS[now.link.state])
        trainee, task = self._trainee, now.taskTitle
        if now.link.state is LinkState.CONNECTED and now.phase in OPEN_PHASES:
            trial = self._session.training.status
            trainee, task = trial.trainee, self._titleOf(trial.task)
        setText(ui.nowTraineeText, shortName(trainee) or _("No trainee"))
        setText(ui.nowTaskText, shortName(task))
        if ui.nextStepButton.text != buttonTitle(step.title):
            ui.nextStepButton.text = buttonTitle(step.title)
            # A new text removes the shortcut.
            ui.nextStepButton.setShortcut(qt.QKeySequence(SHORTCUT))
        isPossible = step.action is not NextAction.WAIT
        tip = _("The next thing to do ({shortcut})").format(shortcut=SHORTCUT)
        setUsable(ui.nextStepButton, isPossible, tip, step.sentence)
        setText(ui.nextStepText, step.sentence)
        self._folding.follow(step.section)

    def _titleOf(self, task: str) -> str:
        if task == TRIAL_RUN:
            return _("Trial run")
        return self._session.taskTitle if task == self._session.task else task

    def _lookUp(self, *_arguments: Any) -> None:
        """Look up the chosen trainee in the study."""
        trainees = self._session.trainees
        if trainees.chosen != self._trainee:
            self._trainee = trainees.chosen
            self._hasPracticed = self._hasNewResult = self._isResultShown = False
        self._studyStep, self._repeatSentence = None, ""
        # The section Trainees shows what is wrong with the study.
        with contextlib.suppress(InputError):
            self._hasTrainees = bool(trainees.trainees())
            self._hasPracticed = self._hasPracticed or bool(trainees.history())
            progress = self._session.study.progress()
            if progress is not None:
                self._studyStep = progress.next_step
                self._repeatSentence = progress.repeat_sentence
        self.showState()

    def _lookAtSetup(self, _error: str = "") -> None:
        # It is in a file, which should not be read at each state of a trial.
        self._isSetUp = self._session.simulator.setup.isCurrent
        self.showState()

    def _followTrial(self, state: Mapping[str, Any]) -> None:
        if state.get("phase") == Phase.RUNNING.value:
            self._isUnscored = self._hasNewResult = self._isResultShown = False
            self._hasPracticed = self._hasPracticed or state.get("trainee") == self._trainee
        self.showState()

    def _takeResult(self, analysis: TrialAnalysis) -> None:
        # Each section shows it in a separate turn; only then is there something to see.
        self._session.work.later(lambda: self._noteResult(analysis.record.trainee))

    def _noteResult(self, trainee: str) -> None:
        if trainee == self._trainee:
            self._hasNewResult = True
        self.showState()

    def _noteProblem(self, _sentence: str) -> None:
        self._isUnscored = True
        self.showState()

    def _noteScoreSeen(self, isFolded: bool) -> None:
        """Treat a result as seen when the user opens its section."""
        if not isFolded and self._hasNewResult:
            self._hasNewResult, self._isResultShown = False, True
            self.showState()
