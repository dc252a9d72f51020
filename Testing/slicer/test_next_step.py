"""The next step: one thing to do at each point of a session."""

from dataclasses import replace

import pytest

from rastrainer.protocol import PROCEDURE_PHASES, Phase, StepKind
from rastrainer.sections.next_step_logic import NextAction, Section, WorkflowState, nextStep
from rastrainer.sections.simulator_logic import ANY, freePort
from rastrainer.slicer.link.link_status import LinkState, LinkStatus
from rastrainer.slicer.program.simulator_program import ProgramState
from Testing.slicer.simulator_double import SimulatorDouble


def link(state):
    return LinkStatus(state, f"The link is {state.value}.", "Do something.")


OFF = WorkflowState(link(LinkState.OFF))
CONNECTED = WorkflowState(
    link(LinkState.CONNECTED), ProgramState.READY, taskTitle="Task 1", total=15
)
CHOSEN = replace(CONNECTED, trainee="T001", hasTrainees=True)
PRACTICED = replace(CHOSEN, hasPracticed=True)


def step_of(situation, **changes):
    return nextStep(replace(situation, **changes))


@pytest.mark.parametrize(
    "situation",
    [CHOSEN, PRACTICED, replace(CHOSEN, studyStep=StepKind.TRIAL)],
    ids=["trial run", "task", "step of a study"],
)
def test_steps_that_start_a_trial_wait_while_a_scenario_is_loading(situation):
    before, step = nextStep(situation), step_of(situation, isLoading=True)
    assert (step.action, step.title, step.section) == (
        NextAction.WAIT,
        before.title,
        before.section,
    )
    assert "still loading a scenario" in step.sentence


def test_steps_that_start_no_trial_do_not_wait_for_a_scenario_to_load():
    for situation in (OFF, CONNECTED, replace(CHOSEN, studyStep=StepKind.QUESTIONNAIRE)):
        assert step_of(situation, isLoading=True) == nextStep(situation)


def test_a_session_leads_from_an_empty_slicer_to_the_next_trial():
    seen = [
        nextStep(situation).title
        for situation in (
            OFF,
            replace(OFF, program=ProgramState.STARTING),
            replace(OFF, link=link(LinkState.GREETING), program=ProgramState.READY),
            CONNECTED,
            CHOSEN,
            replace(CHOSEN, phase="running"),
            replace(CHOSEN, phase="paused"),
            replace(CHOSEN, phase="complete"),
            replace(CHOSEN, phase="registered"),
            replace(PRACTICED, phase="scored", hasNewResult=True),
            replace(PRACTICED, phase="scored", isResultShown=True),
        )
    ]
    assert seen == [
        "Start and connect",
        "Starting…",
        "Connecting…",
        "New trainee",
        "Start the trial run",
        "Pause",
        "Resume",
        "Waiting…",
        "Scoring…",
        "Show result",
        "Start Task 1",
    ]


def test_during_the_tutorial_the_line_says_so_and_how_to_skip_it():
    step = step_of(CHOSEN, isLearning=True)
    assert step.title == "Start the trial run"
    assert step.sentence.startswith("T001 does the tutorial first")
    assert step.sentence.endswith("uncheck Tutorial in the section Training.")
    led = step_of(CHOSEN, isLearning=True, studyStep=StepKind.TRIAL_RUN, studySentence="Step 1.")
    assert (led.title, led.sentence[:25]) == ("Start the step", "T001 does the tutorial fi")
    assert "uncheck" not in led.sentence


def test_the_section_of_a_step_is_the_one_in_which_it_can_be_done():
    assert step_of(OFF, needsSetup=True).section is Section.SETUP
    assert step_of(OFF).section is Section.SIMULATOR
    assert step_of(CONNECTED).section is Section.TRAINEES
    assert step_of(CHOSEN).section is Section.TRAINING
    assert step_of(CHOSEN, phase="running").section is Section.TRAINING
    assert step_of(CHOSEN, phase="complete").section is Section.REGISTRATION
    assert step_of(PRACTICED, hasNewResult=True).section is Section.REGISTRATION
    assert step_of(PRACTICED, isResultShown=True).section is Section.SCORE


@pytest.mark.parametrize("state", list(LinkState))
@pytest.mark.parametrize("program", list(ProgramState))
def test_there_is_a_next_step_whatever_the_link_and_the_program_do(state, program):
    step = nextStep(WorkflowState(link(state), program, "Something happened."))
    assert step.title
    assert step.sentence


def test_an_unexpected_end_is_reported_and_the_program_can_be_started_again():
    ended = step_of(OFF, program=ProgramState.FAILED, programSentence="It ended: no screen.")
    assert (ended.action, ended.sentence) == (NextAction.START_SIMULATOR, "It ended: no screen.")


def test_a_port_used_by_something_else_does_not_prevent_starting():
    assert step_of(OFF, link=link(LinkState.OTHER_PROGRAM)).action is NextAction.START_SIMULATOR
    assert step_of(OFF, link=link(LinkState.ABSENT)).action is NextAction.START_SIMULATOR


def test_a_simulator_on_another_computer_is_only_connected_to():
    assert step_of(OFF, isElsewhere=True).action is NextAction.CONNECT
    assert step_of(OFF, isElsewhere=True, needsSetup=True).action is NextAction.CONNECT
    absent = step_of(OFF, isElsewhere=True, link=link(LinkState.ABSENT))
    assert (absent.action, absent.sentence) == (
        NextAction.WAIT,
        "The link is absent. Do something.",
    )


def test_after_disconnecting_from_a_local_simulator_the_user_can_connect_again():
    assert step_of(OFF, program=ProgramState.READY).action is NextAction.CONNECT


def test_a_running_simulator_is_connected_to_instead_of_starting_another():
    found = step_of(OFF, runningSentence="One runs already.")
    assert (found.action, found.sentence) == (NextAction.CONNECT_TO_RUNNING, "One runs already.")


def test_nothing_can_be_pressed_while_the_simulator_is_being_set_up():
    assert step_of(OFF, isBeingSetUp=True).action is NextAction.WAIT


def test_a_trial_stays_in_view_while_the_simulator_is_silent():
    silent = step_of(CHOSEN, link=link(LinkState.STALE), phase="running")
    assert (silent.action, silent.section) == (NextAction.WAIT, Section.TRAINING)


@pytest.mark.parametrize("phase", [phase.value for phase in Phase])
def test_each_phase_of_a_trial_has_a_title_a_sentence_and_an_action(phase):
    found = step_of(CHOSEN, phase=phase, touched=15)
    assert found.title
    assert found.sentence
    if phase in PROCEDURE_PHASES:
        assert found.action is NextAction.PAUSE


def test_a_study_with_trainees_offers_to_choose_one():
    assert step_of(CONNECTED, hasTrainees=True).action is NextAction.CHOOSE_TRAINEE


def test_a_study_decides_what_its_trainee_does_next():
    actions = {kind: step_of(PRACTICED, studyStep=kind).action for kind in StepKind}
    assert actions == {
        StepKind.TRIAL: NextAction.START_STUDY_STEP,
        StepKind.TRIAL_RUN: NextAction.START_STUDY_STEP,
        StepKind.QUESTIONNAIRE: NextAction.ANSWER,
        StepKind.BREAK: NextAction.WAIT,
    }


def test_a_trial_that_cannot_be_scored_does_not_prevent_the_next_one():
    stuck = step_of(PRACTICED, phase="registered", isUnscored=True)
    assert stuck.action is NextAction.START_TASK


def test_the_preferred_port_is_used_unless_something_listens_there():
    with SimulatorDouble() as listening:
        taken = listening.port
        assert freePort(taken) == ANY
    assert freePort(taken) == taken


def test_an_aborted_step_of_a_study_asks_for_a_reason_before_it_is_started_again():
    step = step_of(PRACTICED, studyStep=StepKind.TRIAL, needsRepeatReason=True)
    assert step.action is NextAction.EXPLAIN_REPEAT
    assert step.section is Section.STUDY
