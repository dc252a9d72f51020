"""The trial's state machine: what each command does in each phase, and its message."""

import itertools

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.journal.entries import Rejected
from rastrainer.protocol import PROCEDURE_PHASES, Phase, TouchRule
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.texts.texts import ENGLISH
from rastrainer_simulator.training.rules import (
    REFUSALS,
    TrainingSettings,
)
from rastrainer_simulator.training.training import REFUSAL_S
from Testing.simulator.training.hand_driven import (
    DRILLED,
    LOCKABLE,
    REGISTRATION,
    SCORE,
    VERTEX,
    Trial,
    at_procedure,
)


def in_phase(scenario, phase):
    """Return a trial in a phase; phases of a procedure belong to a trial with a procedure."""
    if phase in PROCEDURE_PHASES:
        return at_procedure(scenario, phase)
    trial = Trial(scenario)
    if phase is Phase.IDLE:
        return trial
    trial.start()
    trial.touch(1 if phase in (Phase.RUNNING, Phase.PAUSED) else 15)
    if phase is Phase.PAUSED:
        trial.do(CommandName.PAUSE)
    if phase in (Phase.REGISTERED, Phase.SCORED):
        trial.do(CommandName.REGISTER)
    if phase is Phase.SCORED:
        trial.do(CommandName.SUBMIT_REGISTRATION, **REGISTRATION)
        trial.do(CommandName.TRIAL_SCORED, **SCORE)
    assert trial.state.phase is phase
    return trial


@pytest.fixture
def trial(scenario):
    """Return a trial that has begun."""
    trial = Trial(scenario)
    trial.start()
    return trial


RIGHT = {
    CommandName.START_TASK: {Phase.IDLE, Phase.REGISTERED, Phase.SCORED},
    CommandName.CAPTURE: {Phase.RUNNING, Phase.VERIFYING},
    CommandName.UNDO: {Phase.RUNNING, Phase.COMPLETE},
    CommandName.REGISTER: {Phase.COMPLETE},
    CommandName.USE_REGISTRATION: {Phase.VERIFYING},
    CommandName.ACCEPT_REGISTRATION: {Phase.VERIFYING},
    CommandName.REGISTER_AGAIN: {Phase.VERIFYING},
    CommandName.LOCK_GUIDE: {Phase.ALIGNING},
    CommandName.RETRACT_DRILL: {Phase.DRILLING},
    CommandName.START_INSERTION: {Phase.DRILLING},
    CommandName.RELEASE_INSTRUMENT: {Phase.INSERTING},
    CommandName.ABORT: {Phase.RUNNING, Phase.PAUSED, Phase.COMPLETE, *PROCEDURE_PHASES},
    CommandName.PAUSE: {Phase.RUNNING, *PROCEDURE_PHASES},
    CommandName.RESUME: {Phase.PAUSED},
    CommandName.SUBMIT_REGISTRATION: {Phase.REGISTERED, Phase.SCORED},
    CommandName.GET_TRIAL: set(Phase) - {Phase.IDLE},
}
WHAT_WOULD_BE_RIGHT = (
    *("start", "regist", "touch", "resume", "abort", "undo"),
    *("accept", "lock it", "insert the instrument", "release it"),
)
MOMENTS = {
    CommandName.LOCK_GUIDE: LOCKABLE,
    CommandName.START_INSERTION: DRILLED,
    CommandName.RELEASE_INSTRUMENT: DRILLED,
}


@pytest.mark.parametrize(("name", "phase"), list(itertools.product(RIGHT, Phase)))
def test_each_command_is_carried_out_in_its_phases_and_otherwise_refused_with_advice(
    scenario, name, phase
):
    trial = in_phase(scenario, phase)
    before = trial.state
    arguments = {
        CommandName.START_TASK: {"task": "task-2", "trainee": "P02", "mode": "hmd"},
        CommandName.SUBMIT_REGISTRATION: REGISTRATION,
        CommandName.USE_REGISTRATION: trial.exact_registration(),
    }.get(name, {})
    tip = trial.fiducial(before.next_point) if before.next_point else trial.place(VERTEX)
    reply = trial.do(name, tip, feed=MOMENTS.get(name), **arguments)
    assert reply.ok is (phase in RIGHT[name])
    if not reply.ok:
        assert trial.state is before
        assert reply.events == ()
        advice = reply.message.partition(": ")[2] or reply.message
        assert any(word in advice for word in WHAT_WOULD_BE_RIGHT), reply.message
        assert "None" not in reply.message


def test_every_command_of_the_simulation_has_its_phases_defined():
    assert set(RIGHT) <= set(REFUSALS)
    assert {key for phases in REFUSALS.values() for key in phases.values()} <= set(ENGLISH)


def test_a_touch_counts_on_the_skin_or_by_the_papers_rule_at_any_height_within_the_radius(scenario):
    for settings, aside_mm, above_mm, counts in (
        (TrainingSettings(), 9.99, 0.49, True),
        (TrainingSettings(), 10.01, 0.49, False),
        (TrainingSettings(), 0.0, -1.0, True),
        (TrainingSettings(), 0.0, 0.51, False),
        (TrainingSettings(touch_rule=TouchRule.WITHIN_RADIUS), 0.0, 9.0, True),
        (TrainingSettings(touch_rule=TouchRule.WITHIN_RADIUS), 10.01, 0.0, False),
    ):
        trial = Trial(scenario, settings=settings)
        trial.start()
        x, y, z = trial.fiducial("1")
        tip = (x + aside_mm / MM_PER_M, y, z)
        assert trial.do(CommandName.CAPTURE, tip, above_mm).ok is counts


@pytest.mark.parametrize(
    ("away_m", "said"),
    [(0.0102, "11 mm"), (0.0153, "15 mm"), (0.0156, "more than 15 mm")],
)
def test_a_touch_too_far_away_is_refused_with_the_distance_where_it_does_not_lead_there(
    trial, away_m, said
):
    x, y, z = trial.fiducial("1")
    reply = trial.do(CommandName.CAPTURE, (x, y, z + away_m))
    assert reply.message == f"Too far from point 1: {said}; a touch counts within 10 mm."
    assert trial.state.instruction == reply.message
    assert trial.state.rejected == 1
    assert [type(event.entry) for event in reply.events] == [Rejected]


def test_a_refusal_gives_way_to_the_instruction_after_some_seconds(trial):
    asked = trial.state.instruction
    for later_s, is_over in ((0.9 * REFUSAL_S, False), (0.2 * REFUSAL_S, True)):
        if not is_over:
            trial.do(CommandName.CAPTURE, (0.0, 0.0, 2.0))
        trial.now += later_s
        trial.training.end_refusal(trial.now)
        assert (trial.state.instruction == asked) is is_over


def test_completion_time_runs_from_the_start_to_the_last_kept_touch_without_pauses(trial):
    trial.now += 4.0
    trial.touch(14)
    trial.do(CommandName.PAUSE)
    trial.now += 100.0
    assert trial.training.elapsed(trial.now) == 4.0
    trial.do(CommandName.RESUME)
    trial.now += 3.0
    trial.touch()
    trial.now += 50.0
    assert trial.training.elapsed(trial.now) == pytest.approx(7.0)
    assert trial.do(CommandName.REGISTER).data["completionTimeS"] == pytest.approx(7.0)


def test_the_true_errors_of_a_shifted_registration_are_the_shift(trial):
    trial.touch(14)
    x, y, z = trial.fiducial("15")
    trial.do(CommandName.CAPTURE, (x, y + 0.004, z))
    trial.do(CommandName.REGISTER)
    shifted = np.linalg.inv(trial.training.truth.head_to_world)
    shifted[:3, 3] += (1.0, 2.0, 2.0)
    registration = {**REGISTRATION, "matrix": tuple(shifted.ravel())}
    answer = trial.do(CommandName.SUBMIT_REGISTRATION, **registration).data
    assert answer["trueTreMm"] == pytest.approx(3.0)
    assert answer["touchErrorsMm"]["15"] == pytest.approx(4.0)


def test_a_registration_and_a_score_that_arrive_twice_are_answered_twice_and_stored_once(scenario):
    trial = in_phase(scenario, Phase.REGISTERED)
    for command, arguments in (
        (CommandName.SUBMIT_REGISTRATION, REGISTRATION),
        (CommandName.TRIAL_SCORED, SCORE),
    ):
        first, second = (trial.do(command, **arguments) for _ in range(2))
        assert (second.ok, second.data, second.events) == (True, first.data, ())


@pytest.mark.parametrize("phase", [Phase.REGISTERED, Phase.SCORED])
def test_the_pose_is_secret_until_a_registration_is_submitted_which_is_then_final(scenario, phase):
    trial = in_phase(scenario, phase)
    if phase is Phase.REGISTERED:
        assert "headToWorld" not in trial.do(CommandName.GET_TRIAL).data
    revealed = trial.do(CommandName.SUBMIT_REGISTRATION, **REGISTRATION).data
    assert revealed["headToWorld"] == list(trial.training.truth.head_to_world.ravel())
    truth = tuple(np.linalg.inv(trial.training.truth.head_to_world).ravel())
    answer = trial.do(CommandName.SUBMIT_REGISTRATION, **REGISTRATION | {"matrix": truth})
    assert not answer.ok
    assert "final" in answer.message
    again = trial.do(CommandName.GET_TRIAL).data
    for name in ("trueTreMm", "headToWorld"):
        assert again[name] == revealed[name]


def test_an_abort_that_arrives_late_does_not_end_the_next_trial(trial):
    over = trial.state.trial_id
    assert trial.do(CommandName.ABORT, trialId=over).ok
    assert "No trial is running" in trial.do(CommandName.ABORT, trialId=over).message
    trial.start()
    trial.touch(1)
    assert "That trial is over" in trial.do(CommandName.ABORT, trialId=over).message
    assert (trial.state.phase, len(trial.state.touches)) == (Phase.RUNNING, 1)
    assert trial.do(CommandName.ABORT, trialId=trial.state.trial_id).ok


def test_seeds_poses_and_ids_of_trials_follow_from_the_simulators_seed(scenario):
    first, same, other = (Trial(scenario, seed) for seed in (5, 5, 6))
    for trial in (first, same, other):
        trial.start()
    assert first.state.trial_id == same.state.trial_id != other.state.trial_id
    assert first.training.trial_seed == same.training.trial_seed != other.training.trial_seed
    poses = [each.training.truth.head_to_world for each in (first, same, other)]
    assert np.array_equal(poses[0], poses[1])
    assert not np.array_equal(poses[0], poses[2])
    trial_id = first.state.trial_id
    first.do(CommandName.ABORT)
    assert np.array_equal(first.training.truth.head_to_world, scenario.head_to_world)
    first.start()
    assert first.state.trial_id != trial_id


def test_each_touch_must_be_at_its_own_fiducial(trial):
    first = trial.fiducial("1")
    trial.touch()
    assert not trial.do(CommandName.CAPTURE, first).ok
    assert trial.state.next_point == "2"
