"""A procedure, from the registration to the placed instrument, command by command."""

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.journal.entries import AcceptedCheckpoint, Rejected
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.training.feed import Feed, HeadAhead
from rastrainer_simulator.training.rules import RECORDING_FAILED
from Testing.simulator.training.hand_driven import (
    AHEAD,
    DRILLED,
    LOCKABLE,
    REGISTRATION,
    VERTEX,
    Trial,
    at_procedure,
)


def place_line(trial):
    """Go from aligning to the release of the instrument, a second in each phase."""
    for command, feed in (
        (CommandName.LOCK_GUIDE, LOCKABLE),
        (CommandName.START_INSERTION, DRILLED),
        (CommandName.RELEASE_INSTRUMENT, DRILLED),
    ):
        trial.now += 1.0
        reply = trial.must(command, (0.5, 0.0, 0.4), feed=feed)
    return reply


def test_the_phase_times_add_up_to_the_trial_time_without_pauses(scenario):
    trial = at_procedure(scenario, Phase.ALIGNING)
    place_line(trial)
    trial.must(CommandName.PAUSE)
    trial.now += 60.0
    trial.must(CommandName.RESUME)
    place_line(trial)
    procedure = trial.procedure
    assert procedure.times_s == pytest.approx({Phase.RUNNING: 1.0, Phase.VERIFYING: 1.0})
    for line in procedure.trajectories:
        assert line.times_s == pytest.approx(
            dict.fromkeys((Phase.ALIGNING, Phase.DRILLING, Phase.INSERTING), 1.0)
        )
    assert procedure.ended_s == pytest.approx(8.0)
    trial.now += 30.0
    assert trial.training.elapsed(trial.now) == procedure.ended_s
    assert trial.state.touches[-1].elapsed == 0.0


def test_a_registration_is_final_and_its_answer_reveals_nothing_of_the_truth(scenario):
    trial = at_procedure(scenario, Phase.VERIFYING, shift_mm=(1.0, 0.0, 0.0))
    again = trial.must(CommandName.USE_REGISTRATION, **trial.exact_registration((1.0, 0.0, 0.0)))
    assert set(again.data["registration"]) == {"matrix", "freMm", "expectedTreMm"}
    whole = str(again.data)
    assert "headToWorld" not in whole
    assert "true" not in whole.lower()
    assert "headToWorld" not in trial.must(CommandName.GET_TRIAL).data
    other = trial.do(CommandName.USE_REGISTRATION, **trial.exact_registration((0.0, 0.0, 1.0)))
    assert not other.ok
    assert "Another registration is in use" in other.message


def test_true_distances_ahead_of_the_guide_are_recorded_and_never_sent_in_an_answer(scenario):
    trial = at_procedure(scenario, Phase.ALIGNING)
    reply = trial.must(CommandName.LOCK_GUIDE, (0.5, 0.0, 0.4), feed=LOCKABLE)
    assert "ahead" not in reply.data
    (event,) = reply.events
    assert vars(event.entry.ahead) == pytest.approx(
        {"skin_mm": 20.0, "outer_mm": 27.0, "inner_mm": 34.0}
    )
    assert reply.feed == Feed(ahead=AHEAD)


def test_a_registration_that_is_not_rigid_is_refused(scenario):
    trial = Trial(scenario)
    trial.start(procedure="dbs")
    trial.touch(15)
    trial.must(CommandName.REGISTER)
    # Stretched, mirrored, projective, sheared, flat.
    for change in ({0: 1.1}, {0: -1.0}, {12: 0.5}, {1: 0.01}, {0: 0.0, 5: 0.0, 10: 0.0}):
        matrix = list(REGISTRATION["matrix"])
        for place, value in change.items():
            matrix[place] = value
        reply = trial.do(CommandName.USE_REGISTRATION, **{**REGISTRATION, "matrix": tuple(matrix)})
        assert not reply.ok
        assert "rigid" in reply.message
        assert trial.procedure.registration is None


def test_the_error_at_a_checkpoint_follows_from_the_trainees_own_registration(scenario):
    trial = at_procedure(scenario, Phase.VERIFYING, shift_mm=(4.0, 0.0, 0.0))
    reply = trial.must(CommandName.CAPTURE, trial.place(VERTEX + np.array([0.0, 3.0, 0.0])))
    expected = 5.0
    assert reply.data["checkpoint"] == "Vertex"
    assert reply.data["errorMm"] == pytest.approx(expected, abs=1e-9)
    assert f"Vertex is {expected:.1f} mm off with your registration" in trial.state.instruction
    (point,) = trial.procedure.checkpoints
    assert MM_PER_M * point.error == pytest.approx(expected, abs=1e-9)
    assert [type(event.entry) for event in reply.events] == [AcceptedCheckpoint]


@pytest.mark.parametrize(
    ("offset_mm", "above_mm", "words"),
    [
        ((0.0, 0.0, 30.1), 0.0, "Vertex, the nearest by your registration, is 30.1 mm away"),
        ((0.0, 0.0, 0.0), 2.5, "2.5 mm above the skin"),
    ],
)
def test_a_touch_off_every_checkpoint_is_refused_with_what_would_be_right(
    scenario, offset_mm, above_mm, words
):
    trial = at_procedure(scenario, Phase.VERIFYING)
    reply = trial.do(CommandName.CAPTURE, trial.place(VERTEX + offset_mm), above_mm)
    assert not reply.ok
    assert words in reply.message
    assert trial.state.instruction == reply.message
    assert trial.state.rejected == 0
    assert trial.procedure.checkpoints == ()
    assert [type(event.entry) for event in reply.events] == [Rejected]


def test_nothing_is_checked_or_accepted_before_there_is_a_registration(scenario):
    trial = Trial(scenario)
    trial.start(procedure="dbs")
    trial.touch(15)
    trial.must(CommandName.REGISTER)
    for command in (CommandName.CAPTURE, CommandName.ACCEPT_REGISTRATION):
        assert trial.do(command, trial.place(VERTEX)).message.key == "not in use yet"
    assert trial.do(CommandName.REGISTER_AGAIN).ok


@pytest.mark.parametrize(
    ("skin_m", "words"),
    [
        (None, "does not meet the head"),
        (0.0801, "80 mm from the skin along its axis: lock it within 80 mm"),
    ],
)
def test_a_guide_through_which_nothing_can_be_drilled_is_not_locked(scenario, skin_m, words):
    trial = at_procedure(scenario, Phase.ALIGNING)
    before = trial.state
    reply = trial.do(CommandName.LOCK_GUIDE, feed=Feed(ahead=HeadAhead(skin=skin_m)))
    assert words in reply.message
    assert trial.state is before


def test_no_instrument_without_a_hole_and_no_release_inside_the_guide(scenario):
    trial = at_procedure(scenario, Phase.DRILLING)
    assert "Nothing is drilled" in trial.do(CommandName.START_INSERTION, feed=LOCKABLE).message
    exchanged = trial.must(CommandName.START_INSERTION, feed=DRILLED)
    assert exchanged.feed == Feed(0.0, 0.036, AHEAD)
    reply = trial.do(CommandName.RELEASE_INSTRUMENT, feed=exchanged.feed)
    assert "still in the guide" in reply.message
    trial.must(CommandName.RELEASE_INSTRUMENT, feed=Feed(0.09, 0.036, AHEAD))
    line = trial.procedure.trajectories[0]
    assert (line.drill_depth, line.instrument_depth) == (0.036, 0.09)


@pytest.mark.parametrize(
    ("phase", "command", "feed"),
    [
        (Phase.VERIFYING, CommandName.REGISTER_AGAIN, None),
        (Phase.DRILLING, CommandName.RETRACT_DRILL, Feed(0.01, 0.012, AHEAD)),
        (Phase.INSERTING, CommandName.RELEASE_INSTRUMENT, Feed(0.08, 0.036, AHEAD)),
    ],
)
def test_a_change_that_could_not_be_written_is_undone_including_its_feed(
    scenario, phase, command, feed
):
    trial = at_procedure(scenario, phase)
    kept, given = trial.state, feed or Feed()
    trial.must(command, (0.5, 0.0, 0.4), feed=feed)
    now = Feed(0.002, 0.002, AHEAD)
    reply = trial.do(RECORDING_FAILED, feed=now, revision=kept.revision, reason="disk full")
    assert trial.state.phase is Phase.PAUSED
    assert trial.procedure == kept.procedure
    assert reply.feed == given
    trial.must(CommandName.RESUME)
    assert trial.state.phase is phase


def test_attempts_and_checks_are_limited_to_what_a_record_can_hold(scenario, monkeypatch):
    phases = "rastrainer_simulator.training.procedure_phases"
    monkeypatch.setattr(f"{phases}.MAX_ATTEMPTS", 2)
    monkeypatch.setattr(f"{phases}.MAX_TOUCHED_CHECKPOINTS", 3)
    trial = at_procedure(scenario, Phase.VERIFYING)
    for _ in range(2):
        trial.must(CommandName.CAPTURE, trial.place(VERTEX))
    trial.must(CommandName.REGISTER_AGAIN)
    trial.touch(15)
    trial.must(CommandName.REGISTER)
    trial.must(CommandName.USE_REGISTRATION, **trial.exact_registration())
    trial.must(CommandName.CAPTURE, trial.place(VERTEX))
    assert "3 checkpoints" in trial.do(CommandName.CAPTURE, trial.place(VERTEX)).message
    assert "2 times" in trial.do(CommandName.REGISTER_AGAIN).message
    assert trial.do(CommandName.ACCEPT_REGISTRATION).ok
