"""The next step of a session, and the section that belongs to it.

One button leads from an empty Slicer to a score; each step can also be done in its section.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import Enum

from rastrainer.protocol import Phase, StepKind
from rastrainer.sections.training_logic import LOADING, TrialStatus, tutorialSentence
from rastrainer.slicer.link.link_status import LinkState, LinkStatus
from rastrainer.slicer.program.simulator_program import ProgramState
from rastrainer.slicer.translation import _
from rastrainer.study.protocol.steps import StepProgress, instruction


class NextAction(str, Enum):
    """Actions of the button."""

    WAIT = "wait"
    START_SIMULATOR = "start simulator"
    CONNECT = "connect"
    CONNECT_TO_RUNNING = "connect to running"
    CREATE_TRAINEE = "create trainee"
    CHOOSE_TRAINEE = "choose trainee"
    START_TRIAL_RUN = "start trial run"
    START_TASK = "start task"
    START_STUDY_STEP = "start study step"
    EXPLAIN_REPEAT = "explain repeat"
    ANSWER = "answer"
    PAUSE = "pause"
    RESUME = "resume"
    SHOW_RESULT = "show result"


class Section(str, Enum):
    """The sections that are opened when their step comes, and folded after it."""

    SETUP = "setup"
    SIMULATOR = "simulator"
    TRAINEES = "trainees"
    STUDY = "study"
    TRAINING = "training"
    REGISTRATION = "registration"
    SCORE = "score"


@dataclass(frozen=True)
class NextStep:
    """The one thing to do now: what the button does and says, why, and where that belongs."""

    action: NextAction
    title: str
    sentence: str
    section: Section


@dataclass(frozen=True)
class WorkflowState:
    """State of a session, with the chosen trainee.

    Attributes:
        isElsewhere: the simulator is to be on another computer.
        runningSentence: says that a simulator not started from here is running; empty if none is.
        hasPracticed: the trainee has played before, be it the trial run alone.
        isLearning: the trainee does the tutorial before the trial run.
        isDeciding: the trainee's drill was started, and has not arrived.
        isUnscored: the trial that was registered last could not be kept or scored.
        hasNewResult: a trial of the trainee was scored and has not been viewed.
        progress: in the study; None for a trainee who practices freely.
    """

    link: LinkStatus
    program: ProgramState = ProgramState.STOPPED
    programSentence: str = ""
    needsSetup: bool = False
    isBeingSetUp: bool = False
    isElsewhere: bool = False
    runningSentence: str = ""
    trainee: str = ""
    hasTrainees: bool = False
    hasPracticed: bool = False
    isLearning: bool = False
    isDeciding: bool = False
    taskTitle: str = ""
    trial: TrialStatus = field(default_factory=TrialStatus)
    isLoading: bool = False
    isUnscored: bool = False
    hasNewResult: bool = False
    isResultShown: bool = False
    progress: StepProgress | None = None


def nextStep(now: WorkflowState) -> NextStep:
    """Return the next thing to do."""
    if not now.link.isConnected:
        return _untilConnected(now)
    trial = now.trial
    if trial.isOpen or (trial.phase == Phase.REGISTERED.value and not now.isUnscored):
        step = _DURING_TRIAL[trial.phase]
        text = step.sentence.format(touched=trial.touched, total=trial.total)
        return replace(step, sentence=text)
    if now.hasNewResult:
        text = _("The trial of {trainee} is scored.").format(trainee=now.trainee)
        return NextStep(NextAction.SHOW_RESULT, _("Show result"), text, Section.REGISTRATION)
    if not now.trainee and now.hasTrainees:
        text = _("Choose who is training, or create a new trainee.")
        return NextStep(NextAction.CHOOSE_TRAINEE, _("Choose a trainee"), text, Section.TRAINEES)
    if not now.trainee:
        text = _("A pseudonym is assigned, unless you type one below.")
        return NextStep(NextAction.CREATE_TRAINEE, _("New trainee"), text, Section.TRAINEES)
    step = _trial(now)
    if now.isLoading and step.action in _STARTS:
        return replace(step, action=NextAction.WAIT, sentence=LOADING)
    return step


_STARTS = (NextAction.START_TRIAL_RUN, NextAction.START_TASK, NextAction.START_STUDY_STEP)
_TOUCHED = _("{touched} of {total} points are touched.")
_COMPLETE = _("All points are touched: the trainee registers them, or undoes some.")
_ALIGNING = _("The trainee aligns the guide with the planned trajectory.")
_SCORING = _("The trial is registered, and is being scored.")
_PAUSE = NextStep(NextAction.PAUSE, _("Pause"), _TOUCHED, Section.TRAINING)
_WAIT = NextStep(NextAction.WAIT, _("Scoring…"), _SCORING, Section.REGISTRATION)
_DURING_TRIAL = {
    Phase.RUNNING.value: _PAUSE,
    Phase.PAUSED.value: NextStep(NextAction.RESUME, _("Resume"), _TOUCHED, Section.TRAINING),
    Phase.COMPLETE.value: replace(_WAIT, title=_("Waiting…"), sentence=_COMPLETE),
    Phase.VERIFYING.value: replace(_PAUSE, sentence=_("The trainee verifies the registration.")),
    Phase.ALIGNING.value: replace(_PAUSE, sentence=_ALIGNING),
    Phase.DRILLING.value: replace(_PAUSE, sentence=_("The trainee drills through the skull.")),
    Phase.INSERTING.value: replace(_PAUSE, sentence=_("The trainee inserts the instrument.")),
    Phase.REGISTERED.value: _WAIT,
}


def _untilConnected(now: WorkflowState) -> NextStep:
    text, here = f"{now.link.sentence} {now.link.remedy}".strip(), Section.SIMULATOR
    if now.isBeingSetUp:
        text = _("The simulator is being set up, which takes some minutes.")
        return NextStep(NextAction.WAIT, _("Setting up…"), text, Section.SETUP)
    if now.program in (ProgramState.STARTING, ProgramState.STOPPING):
        title = _("Starting…") if now.program is ProgramState.STARTING else _("Ending…")
        return NextStep(NextAction.WAIT, title, now.programSentence, here)
    if now.link.state in (LinkState.NOT_INSTALLED, LinkState.WRONG_VERSION):
        return NextStep(NextAction.WAIT, _("Not connected"), text, here)
    if now.link.state is LinkState.STALE and now.trial.isOpen:
        return NextStep(NextAction.WAIT, _("Waiting…"), text, Section.TRAINING)
    if now.runningSentence and now.link.state in (LinkState.OFF, LinkState.ABSENT):
        text = now.runningSentence
        return NextStep(NextAction.CONNECT_TO_RUNNING, _("Connect to it"), text, here)
    isThere = now.isElsewhere or now.program is ProgramState.READY
    isBegun = now.link.state in (LinkState.GREETING, LinkState.STALE)
    if isBegun or (isThere and now.link.state is not LinkState.OFF):
        return NextStep(NextAction.WAIT, _("Connecting…"), text, here)
    if isThere:
        text = _("Host and port are set under Advanced in the section Simulator.")
        return NextStep(NextAction.CONNECT, _("Connect"), text, here)
    text = _("The simulator starts on this computer, and Slicer connects to it.")
    if now.program is ProgramState.FAILED:
        text = now.programSentence
    elif now.needsSetup:
        text = _("The simulator is set up first, once, after you have agreed.")
        here = Section.SETUP
    return NextStep(NextAction.START_SIMULATOR, _("Start and connect"), text, here)


_STUDY_STEPS = {
    StepKind.TRIAL: (NextAction.START_STUDY_STEP, _("Start the step")),
    StepKind.DECIDE: (NextAction.START_STUDY_STEP, _("Start the step")),
    StepKind.TRIAL_RUN: (NextAction.START_STUDY_STEP, _("Start the step")),
    StepKind.QUESTIONNAIRE: (NextAction.ANSWER, _("Answer")),
    StepKind.BREAK: (NextAction.WAIT, _("Break")),
}


def _trial(now: WorkflowState) -> NextStep:
    step = None if now.progress is None else now.progress.next_step
    if now.isDeciding:
        text = _("{trainee} does a drill at the simulator; one that was left goes on from here.")
        action = NextAction.START_TASK if step is None else NextAction.START_STUDY_STEP
        text = text.format(trainee=now.trainee)
        return NextStep(action, _("Show the drill"), text, Section.TRAINING)
    if now.progress is not None and step is not None:
        repeat = now.progress.repeat_sentence
        action, title = _STUDY_STEPS[StepKind(step.kind)]
        if repeat:
            action, title = NextAction.EXPLAIN_REPEAT, _("Reason for the repeat…")
        here = Section.SCORE if now.isResultShown else Section.STUDY
        text = tutorialSentence(now.trainee) if now.isLearning else repeat or instruction(step)
        return NextStep(action, title, text, here)
    here = Section.SCORE if now.isResultShown else Section.TRAINING
    if not now.hasPracticed:
        text = _("The trial run does not count. The trainee follows the instructions on screen.")
        if now.isLearning:
            without = _("To start without it, uncheck Tutorial in the section Training.")
            text = f"{tutorialSentence(now.trainee)} {without}"
        return NextStep(NextAction.START_TRIAL_RUN, _("Start the trial run"), text, here)
    title = _("Start {task}").format(task=now.taskTitle)
    text = _("Another task or head is chosen in the section Scenario.")
    return NextStep(NextAction.START_TASK, title, text, here)
