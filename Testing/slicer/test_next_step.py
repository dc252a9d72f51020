"""The next step: one thing to do at each point of a session."""

from dataclasses import replace

from rastrainer.json_records import record_from_json
from rastrainer.protocol import PROCEDURE_PHASES, StepKind
from rastrainer.sections.next_step_logic import NextAction, Section, WorkflowState, nextStep
from rastrainer.sections.simulator_logic import freePort
from rastrainer.sections.training_logic import TrialStatus
from rastrainer.slicer.link.link_status import LinkState, LinkStatus
from rastrainer.slicer.program.simulator_program import ProgramState
from rastrainer.study.protocol.steps import StepProgress
from rastrainer.study_messages import StudyStep
from rastrainer.trial.record import AbortedTrial
from Testing.domain.trial.trial_records import make_aborted
from Testing.slicer.simulator_double import SimulatorDouble


def link(state):
    return LinkStatus(state, f"The link is {state.value}.", "Do something.")


OFF = WorkflowState(link(LinkState.OFF))
CONNECTED = WorkflowState(link(LinkState.CONNECTED), ProgramState.READY, taskTitle="Task 1")
CHOSEN = replace(CONNECTED, trainee="T001", hasTrainees=True)
PRACTICED = replace(CHOSEN, hasPracticed=True)


def in_study(kind, *aborted):
    """A trainee whose next step in a study is of a kind."""
    step = StudyStep("T001", kind, questionnaire="ssq", minutes=5.0)
    return replace(PRACTICED, progress=StepProgress((step,), (), unexplained=aborted))


def step_of(situation, **changes):
    return nextStep(replace(situation, **changes))


def test_only_steps_that_start_a_trial_wait_while_a_scenario_is_loading():
    for situation in (CHOSEN, PRACTICED, in_study(StepKind.TRIAL)):
        before, step = nextStep(situation), step_of(situation, isLoading=True)
        waiting = NextAction.WAIT, before.title, before.section
        assert (step.action, step.title, step.section) == waiting
        assert "still loading a scenario" in step.sentence
    for situation in (OFF, CONNECTED, in_study(StepKind.QUESTIONNAIRE)):
        assert step_of(situation, isLoading=True) == nextStep(situation)


GREETING = replace(OFF, link=link(LinkState.GREETING), program=ProgramState.READY)
SCORED = replace(PRACTICED, trial=TrialStatus(phase="scored"))
JOURNEY = [
    (OFF, "Start and connect", Section.SIMULATOR),
    (replace(OFF, needsSetup=True), "Start and connect", Section.SETUP),
    (replace(OFF, program=ProgramState.STARTING), "Starting…", Section.SIMULATOR),
    (GREETING, "Connecting…", Section.SIMULATOR),
    (CONNECTED, "New trainee", Section.TRAINEES),
    (CHOSEN, "Start the trial run", Section.TRAINING),
    (replace(CHOSEN, trial=TrialStatus(phase="running")), "Pause", Section.TRAINING),
    (replace(CHOSEN, trial=TrialStatus(phase="paused")), "Resume", Section.TRAINING),
    (replace(CHOSEN, trial=TrialStatus(phase="complete")), "Waiting…", Section.REGISTRATION),
    (replace(CHOSEN, trial=TrialStatus(phase="registered")), "Scoring…", Section.REGISTRATION),
    (replace(SCORED, hasNewResult=True), "Show result", Section.REGISTRATION),
    (replace(SCORED, isResultShown=True), "Start Task 1", Section.SCORE),
]


def test_a_session_leads_from_an_empty_slicer_to_the_next_trial_each_step_in_its_section():
    steps = [nextStep(situation) for situation, _title, _section in JOURNEY]
    found = [(step.title, step.section) for step in steps]
    assert found == [(title, section) for _situation, title, section in JOURNEY]


REGISTERED = TrialStatus(phase="registered")
ABORTED = record_from_json(AbortedTrial, make_aborted())
SPECIAL = {
    "another program at the port": (
        replace(OFF, link=link(LinkState.OTHER_PROGRAM)),
        NextAction.START_SIMULATOR,
    ),
    "no answer": (replace(OFF, link=link(LinkState.ABSENT)), NextAction.START_SIMULATOR),
    "no set-up elsewhere": (replace(OFF, isElsewhere=True, needsSetup=True), NextAction.CONNECT),
    "disconnected from its own": (replace(OFF, program=ProgramState.READY), NextAction.CONNECT),
    "being set up": (replace(OFF, isBeingSetUp=True), NextAction.WAIT),
    "nobody chosen": (replace(CONNECTED, hasTrainees=True), NextAction.CHOOSE_TRAINEE),
    "not scored": (replace(PRACTICED, trial=REGISTERED, isUnscored=True), NextAction.START_TASK),
    "aborted step": (in_study(StepKind.TRIAL, ABORTED), NextAction.EXPLAIN_REPEAT),
}


def test_the_button_does_what_a_special_situation_needs():
    found = {case: nextStep(situation).action for case, (situation, _action) in SPECIAL.items()}
    assert found == {case: action for case, (_situation, action) in SPECIAL.items()}
    for phase in PROCEDURE_PHASES:
        found = step_of(CHOSEN, trial=TrialStatus(phase=phase.value))
        assert found.action is NextAction.PAUSE


def test_the_line_says_what_is_wrong():
    ended = step_of(OFF, program=ProgramState.FAILED, programSentence="It ended: no screen.")
    assert (ended.action, ended.sentence) == (NextAction.START_SIMULATOR, "It ended: no screen.")
    absent = step_of(OFF, isElsewhere=True, link=link(LinkState.ABSENT))
    assert (absent.action, absent.sentence[:20]) == (NextAction.WAIT, "The link is absent. ")
    found = step_of(OFF, runningSentence="One runs already.")
    assert (found.action, found.sentence) == (NextAction.CONNECT_TO_RUNNING, "One runs already.")
    silent = step_of(CHOSEN, link=link(LinkState.STALE), trial=TrialStatus(phase="running"))
    assert (silent.action, silent.section) == (NextAction.WAIT, Section.TRAINING)


def test_a_study_decides_what_its_trainee_does_next():
    actions = {kind: nextStep(in_study(kind)).action for kind in StepKind}
    assert actions == {
        StepKind.TRIAL: NextAction.START_STUDY_STEP,
        StepKind.TRIAL_RUN: NextAction.START_STUDY_STEP,
        StepKind.DECIDE: NextAction.START_STUDY_STEP,
        StepKind.QUESTIONNAIRE: NextAction.ANSWER,
        StepKind.BREAK: NextAction.WAIT,
    }


def test_the_preferred_port_is_used_unless_something_listens_there():
    with SimulatorDouble() as listening:
        taken = listening.port
        assert freePort(taken) == 0
    assert freePort(taken) == taken
