"""The archive of registered trials: deliveries, and the truth kept until scored."""

import gc
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.journal.entries import FORMAT, FORMAT_VERSION, Stamp
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_to_json
from rastrainer.trial.record import TouchedPoint, TrialRecord
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_archive import (
    SUFFIX,
    ArchivedTrial,
    TrialArchive,
    find_unacknowledged,
)
from rastrainer_simulator.training.head_pose import Truth

TRIAL_ID = "5c6f1d0e-6a4e-4c37-9d0c-0f6a2f7d9b11"
UTC = "2024-05-17T09:30:00.000Z"
HEAD_TO_WORLD = np.array([[-1.0, 0, 0, 500], [0, -1, 0, 20], [0, 0, 1, 300], [0, 0, 0, 1]])
FIDUCIALS = {str(i): np.array([10.0 * i, -5.0 * i, i * i]) for i in range(1, 16)}
TRUTH = Truth(HEAD_TO_WORLD, np.array([1.0, 2.0, 3.0]), FIDUCIALS)
RECORD = TrialRecord(
    trial_id=TRIAL_ID,
    trainee="P01",
    task="task-1",
    mode="desktop",
    scenario="colin27",
    started_utc=UTC,
    completed_utc=UTC,
    completion_time_s=93.5,
    points=tuple(
        TouchedPoint(label, tuple(TRUTH.in_world(point).tolist()), float(label), UTC)
        for label, point in FIDUCIALS.items()
    ),
    rejected_touches=1,
    undone_touches=0,
    versions={"rastrainer": "0"},
)
REGISTRATION = {
    "trialId": TRIAL_ID,
    "matrix": tuple(np.linalg.inv(HEAD_TO_WORLD).ravel()),
    "freMm": 1.0,
    "expectedTreMm": 1.0,
}
SCORE = {
    "trialId": TRIAL_ID,
    "score": 50.0,
    "details": {"kind": "acknowledged", "previous": "0" * 64},
}
NOW = Stamp.now(0, 0.0)


def write_trial(folder, *more, trial_id=TRIAL_ID):
    journal = Journal(folder / f"20240517T093000Z_{trial_id}{SUFFIX}")
    header = {"kind": "header", "format": FORMAT, "version": FORMAT_VERSION}
    registered = {
        "kind": "registered",
        "record": record_to_json(RECORD) | {"trialId": trial_id},
        "truth": record_to_json(TRUTH),
        "seed": 7,
    }
    samples = [{"kind": "sample", "i": i} for i in range(2000)]
    journal.write([header, *samples, registered, *more], sync=False)
    journal.close()
    return journal.path


def sealed(path):
    """Return the record as it is delivered: with the hash of its line."""
    (registered,) = read_journal(path).of_kind("registered")
    return replace(RECORD, journal_sha256=registered["sha256"])


def test_a_registered_trial_is_offered_until_acknowledged_even_after_a_restart(tmp_path):
    path = write_trial(tmp_path)
    archive = TrialArchive(tmp_path)
    assert archive.unacknowledged() == (sealed(path),)
    archive.answer(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": TRIAL_ID}, NOW)
    assert archive.unacknowledged() == ()
    assert TrialArchive(tmp_path).unacknowledged() == ()
    assert read_journal(path).integrity is Integrity.INTACT


def test_the_truth_of_an_older_trial_is_revealed_only_for_a_registration(tmp_path):
    path = write_trial(tmp_path)
    archive = TrialArchive(tmp_path)
    before = archive.answer(CommandName.GET_TRIAL, {"trialId": TRIAL_ID}, NOW)
    assert before["record"] == record_to_json(sealed(path))
    assert not {"headToWorld", "trueTreMm", "seed"} & set(before)
    answer = archive.answer(CommandName.SUBMIT_REGISTRATION, REGISTRATION, NOW)
    assert answer["headToWorld"] == list(HEAD_TO_WORLD.ravel())
    assert answer["trueTreMm"] == pytest.approx(0.0, abs=1e-9)
    assert max(answer["touchErrorsMm"].values()) == pytest.approx(0.0, abs=1e-9)
    restarted = TrialArchive(tmp_path)
    after = restarted.answer(CommandName.GET_TRIAL, {"trialId": TRIAL_ID}, NOW)
    assert (after["trueTreMm"], after["seed"]) == (answer["trueTreMm"], 7)
    for each in (archive, restarted):
        assert each.answer(CommandName.SUBMIT_REGISTRATION, REGISTRATION, NOW) == answer
        with pytest.raises(InputError, match="This registration is final"):
            each.answer(CommandName.SUBMIT_REGISTRATION, REGISTRATION | {"freMm": 2.0}, NOW)


def test_a_score_whose_details_look_like_an_acknowledgment_acknowledges_nothing(tmp_path):
    path = write_trial(tmp_path, {"kind": "registration", "arguments": REGISTRATION})
    TrialArchive(tmp_path).answer(CommandName.TRIAL_SCORED, SCORE, NOW)
    assert TrialArchive(tmp_path).unacknowledged() == (sealed(path),)


def test_a_completed_trial_takes_no_memory_and_is_answered_as_before(tmp_path):
    path = write_trial(tmp_path)
    archive = TrialArchive(tmp_path)
    archive.answer(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": TRIAL_ID}, NOW)
    truth = archive.answer(CommandName.SUBMIT_REGISTRATION, REGISTRATION, NOW)
    archive.answer(CommandName.TRIAL_SCORED, SCORE, NOW)
    gc.collect()
    assert not [each for each in gc.get_objects() if type(each) is ArchivedTrial]
    for _ in range(3):
        assert archive.answer(CommandName.SUBMIT_REGISTRATION, REGISTRATION, NOW) == truth
        assert archive.answer(CommandName.TRIAL_SCORED, SCORE, NOW) == {"trialId": TRIAL_ID}
        assert archive.answer(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": TRIAL_ID}, NOW)
        data = archive.answer(CommandName.GET_TRIAL, {"trialId": TRIAL_ID}, NOW)
        assert data["phase"] == "scored"
        assert data["trueTreMm"] == truth["trueTreMm"]
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    for kind in ("registration", "scored", "acknowledged"):
        assert len(reading.of_kind(kind)) == 1


def test_an_altered_journal_is_named_and_not_delivered(tmp_path):
    path = write_trial(tmp_path)
    path.write_bytes(path.read_bytes().replace(b'"i":1000', b'"i":1001'))
    archive = TrialArchive(tmp_path)
    assert archive.unacknowledged() == ()
    assert path.name in archive.problems[0]
    assert "altered" in archive.problems[0]


@pytest.mark.parametrize(
    "odd",
    [{"record": {}}, {"truth": {}}, {"truth": record_to_json(TRUTH) | {"headToWorld": [1.0, 2.0]}}],
    ids=["empty record", "no truth", "half a matrix"],
)
def test_a_journal_with_valid_hashes_and_odd_content_is_named_and_blocks_no_other(tmp_path, odd):
    registered = {
        "kind": "registered",
        "record": record_to_json(RECORD),
        "truth": record_to_json(TRUTH),
    }
    path = write_trial(tmp_path, registered | odd)
    other_id = TRIAL_ID.replace("5c6f", "0000")
    write_trial(tmp_path, trial_id=other_id)
    archive = TrialArchive(tmp_path)
    assert [record.trial_id for record in archive.unacknowledged()] == [other_id]
    (problem,) = archive.problems
    assert path.name in problem
    assert "not delivered" in problem


def test_trials_are_found_before_any_number_of_later_lines_and_among_foreign_files(tmp_path):
    (tmp_path / f"notes{SUFFIX}").write_text("hello")
    (tmp_path / f"zeros{SUFFIX}").write_bytes(bytes(1_000_000))
    (tmp_path / "notes.txt").write_text("hello")
    scored = {"kind": "scored", "arguments": SCORE | {"details": {"x": "y" * 60_000}}}
    path = write_trial(tmp_path, *[scored] * 12)
    assert find_unacknowledged(tmp_path) == [path]
