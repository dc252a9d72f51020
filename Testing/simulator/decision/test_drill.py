"""A drill: everything counts once it is on the disk, also after a kill and on a full disk."""

import os
import shutil

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.decision.drill_record import CASE_S, CASES, CHECK_S, Decision, DrillRecord, Fault
from rastrainer.errors import InputError
from rastrainer.journal.entries import Stamp
from rastrainer.journal.folder import (
    DRILL_SUFFIX,
    SUFFIX,
    erase_journals,
    journals,
    newest_journal,
)
from rastrainer.journal.journal_file import SEED_SUFFIX, Integrity, read_journal
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.decision.drill import CLOCK_S, TIP, continue_drill
from rastrainer_simulator.record.journal_writer import RecordError, RecordsFolder
from rastrainer_simulator.record.trial_archive import TrialArchive
from Testing.simulator.decision.drills import SEED, Seat, cheap_forms, decide_all, shown
from Testing.simulator.record.test_interrupted_trial import Server, cut, on_full_disk

NOW = Stamp.now(0, 0.0)


@pytest.fixture(scope="module")
def simulation(setup):
    return Simulation(setup, 3)


@pytest.fixture(autouse=True)
def _cheap_forms():
    with cheap_forms():
        yield


@pytest.fixture
def seat(simulation, tmp_path):
    seat = Seat(simulation, tmp_path)
    yield seat
    seat.loop.stop()


@pytest.fixture(scope="module")
def finished(simulation, tmp_path_factory):
    """Return a folder with a finished drill; to be copied."""
    folder = tmp_path_factory.mktemp("finished")
    seat = Seat(simulation, folder)
    with cheap_forms():
        decide_all(seat.begin()).close()
    seat.delivered()
    seat.loop.stop()
    return folder


@pytest.fixture
def copied(finished, tmp_path):
    return shutil.copytree(finished, tmp_path / "copied")


def seen_of(drill):
    """Return what a page shows of a drill."""
    told = (drill.number, drill.checks, drill.has_read_images, drill.decided, len(drill.cases))
    return *told, round(drill.time_s, 6), drill.is_over


def continued(seat, path):
    return continue_drill(path, seat.loop, ())


def test_the_clock_runs_while_a_case_is_undecided_and_each_check_takes_its_time(seat):
    drill = seat.begin()
    assert (drill.number, drill.count, drill.left_s) == (1, CASES, CASE_S)
    drill.advance(1.5)
    first, *_ = drill.case.places
    drill.check(first)
    drill.check(TIP)
    assert drill.checks == (first, TIP)
    assert drill.left_s == pytest.approx(CASE_S - 1.5 - 2 * CHECK_S)
    drill.decide(Decision.PROCEED, 90, Fault.SCALED)
    decided = drill.decided
    assert decided.time_s == pytest.approx(1.5 + 2 * CHECK_S)
    assert (decided.checks, decided.suspected, decided.confidence) == ((first, TIP), None, 90)
    drill.advance(50.0)
    assert (drill.decided, drill.time_s) == (decided, decided.time_s)
    drill.next_case()
    assert (shown(drill).number, drill.left_s, drill.checks) == (2, CASE_S, ())


def test_when_the_time_is_over_nothing_is_checked_and_the_trainee_still_decides(seat):
    drill = seat.begin()
    for _ in range(200):
        drill.advance(1.0)
    assert drill.left_s == 0.0
    with pytest.raises(InputError, match="no time left for a check"):
        drill.check(TIP)
    drill.decide(Decision.REGISTER_AGAIN, 50, Fault.SLID_TRACE)
    assert drill.decided.time_s > CASE_S
    assert seat.begin("P02").case.places
    with pytest.raises(InputError, match="no place 'elsewhere'"):
        seat.begin("P03").check("elsewhere")


def test_what_was_done_is_in_the_journal_before_it_is_shown_and_the_truth_only_once_decided(seat):
    drill = seat.begin()
    drill.check(TIP)
    drill.read_images()
    drill.read_images()
    reading = read_journal(seat.path)
    assert [entry["kind"] for entry in reading.entries] == ["header", "case", "check", "images"]
    assert (reading.header.task, reading.header.trainee) == ("decide", "P01")
    written = seat.path.read_text()
    for secret in (SEED, drill.case.seed, drill.case.fault.value, drill.case.true_error_mm):
        assert str(secret) not in written.partition("\n")[2]
    assert seat.path.with_suffix(SEED_SUFFIX).stat().st_mode & 0o077 == 0
    drill.decide(Decision.STOP, 70, Fault.OTHER_PATIENT)
    (decided,) = read_journal(seat.path).of_kind("decided")
    assert decided["case"] == record_to_json(drill.decided)


def test_a_drill_killed_after_any_line_continues_there_with_its_clock_checks_and_decisions(
    seat, tmp_path
):
    drill = seat.begin()
    states, cases = [], {}

    def note():
        states.append(seen_of(drill))
        cases[drill.number] = drill.case

    note()
    for step in (
        lambda: drill.check(TIP),
        drill.read_images,
        lambda: [drill.advance(CLOCK_S / 3) for _ in range(3)],
        lambda: drill.decide(Decision.STOP, 60, Fault.SWAPPED),
        lambda: (drill.next_case(), shown(drill)),
        lambda: drill.check(TIP),
    ):
        step()
        note()
    lines = seat.path.read_bytes().splitlines(keepends=True)
    assert len(lines) == 1 + len(states)
    for number, state in enumerate(states, start=2):
        killed = tmp_path / str(number) / seat.path.name
        killed.parent.mkdir()
        for suffix in (DRILL_SUFFIX, SEED_SUFFIX):
            shutil.copy(seat.path.with_suffix(suffix), killed.with_suffix(suffix))
        size = len(b"".join(lines[:number]))
        # The next line was being written.
        cut(killed, min(size + 20, seat.path.stat().st_size))
        again = shown(continued(seat, killed))
        assert seen_of(again) == state
        assert again.case.seed == cases[again.number].seed
        np.testing.assert_array_equal(again.case.registration, cases[again.number].registration)
        again.close()
    assert seen_of(decide_all(continued(seat, seat.path)))[-1]
    assert read_journal(seat.path).integrity is Integrity.INTACT


def test_on_a_full_disk_nothing_counts_time_stands_still_and_the_drill_goes_on_with_room(
    seat, monkeypatch
):
    with monkeypatch.context() as full:
        full.setattr(os, "write", on_full_disk)
        with pytest.raises(RecordError, match="cannot be recorded"):
            seat.begin()
    assert list(seat.folder.glob(f"*{DRILL_SUFFIX}")) == []
    drill = seat.begin()
    drill.check(TIP)
    before, written = seen_of(drill), seat.path.read_bytes()
    with monkeypatch.context() as full:
        full.setattr(os, "write", on_full_disk)
        for refused in (
            lambda: drill.check(TIP),
            drill.read_images,
            lambda: drill.decide(Decision.PROCEED, 100, None),
        ):
            with pytest.raises(RecordError, match=r"not recorded does not count; make room"):
                refused()
        for _ in range(3):
            drill.advance(CLOCK_S / 2)
            with pytest.raises(RecordError, match="No space left"):
                drill.advance(CLOCK_S / 2)
        assert seen_of(drill) == before
        assert seat.path.read_bytes() == written
    drill.advance(CLOCK_S)
    assert drill.time_s == pytest.approx(before[-2] + CLOCK_S)
    drill.decide(Decision.PROCEED, 100, None)
    reading = read_journal(seat.path)
    assert reading.integrity is not Integrity.ALTERED
    assert [entry["kind"] for entry in reading.entries] == [
        *("header", "case", "check", "case", "decided")
    ]


def test_a_finished_drill_is_offered_until_it_is_acknowledged_even_after_a_restart(copied):
    (path,) = copied.glob(f"*{DRILL_SUFFIX}")
    archive = TrialArchive(copied)
    (record,) = archive.unacknowledged()
    assert isinstance(record, DrillRecord)
    assert record_from_json(DrillRecord, record_to_json(record)) == record
    (end,) = read_journal(path).of_kind("drill")
    assert record.journal_sha256 == end["sha256"]
    assert len({case.seed for case in record.cases}) == CASES
    assert not path.with_suffix(SEED_SUFFIX).exists()
    trial = {"trialId": record.trial_id}
    got = archive.answer(CommandName.GET_TRIAL, trial, NOW)
    assert (got["phase"], got["record"]) == ("decided", record_to_json(record))
    for command in (
        CommandName.SUBMIT_REGISTRATION,
        CommandName.TRIAL_SCORED,
        CommandName.GET_JOURNAL,
    ):
        with pytest.raises(InputError, match="is a drill; it has no registration and no score"):
            archive.answer(command, trial, NOW)
    for _ in range(2):
        archive.answer(CommandName.ACKNOWLEDGE_TRIAL, trial, NOW)
        assert archive.unacknowledged() == TrialArchive(copied).unacknowledged() == ()
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    assert len(reading.of_kind("acknowledged")) == 1


def test_an_altered_drill_is_neither_delivered_nor_continued(copied, seat):
    (path,) = copied.glob(f"*{DRILL_SUFFIX}")
    path.write_bytes(path.read_bytes().replace(b'"decision":"stop"', b'"decision":"proceed"', 1))
    archive = TrialArchive(copied)
    assert archive.unacknowledged() == ()
    assert any("altered" in problem for problem in archive.problems)
    assert main(["verify", str(path)]) == 1
    with pytest.raises(InputError, match="the drill cannot be continued"):
        continued(seat, path)


def test_drills_are_verified_and_no_reader_takes_them_for_trials(copied, simulation, capsys):
    (path,) = copied.glob(f"*{DRILL_SUFFIX}")
    assert main(["verify", str(path)]) == 0
    assert "intact" in capsys.readouterr().out
    assert newest_journal(copied) is None
    assert find_interrupted(copied) is None
    assert journals(copied) == []
    with Server(simulation, copied) as server:
        server.start()
        server.do(CommandName.ABORT)
        server.loop._writer.submit(lambda: None).result()
        drill, aborted = sorted(server.loop.archive.unacknowledged(), key=lambda r: r.task)
    assert (drill.task, aborted.task, aborted.number) == ("decide", "task-1", 1)
    path.chmod(0o644)
    RecordsFolder(copied).close()
    assert path.stat().st_mode & 0o077 == 0


def test_a_deleted_trainees_drills_are_gone_with_their_seeds_open_ones_too(seat):
    drill, other = seat.begin(), seat.begin("P02")
    seat_of = {path: read_journal(path).header.trainee for path in seat.folder.glob("*.drill")}
    erased, unreadable = erase_journals(seat.folder, "P01")
    assert [seat_of[path] for path in erased] == ["P01"]
    assert unreadable == []
    assert b"P01" not in b"".join(path.read_bytes() for path in seat.folder.iterdir())
    assert len(list(seat.folder.glob(f"*{SEED_SUFFIX}"))) == 1
    with pytest.raises(RecordError, match="No such file"):
        drill.check(TIP)
    other.check(TIP)
    assert list(seat.folder.glob(f"*{SUFFIX}")) == []


def test_a_drill_that_cannot_be_continued_is_delivered_as_abandoned_with_its_number(seat):
    drill = seat.begin()
    drill.advance(1.0)
    drill.check(TIP)
    drill.decide(Decision.STOP, 70, None)
    drill.next_case()
    shown(drill).advance(1.5)
    drill.close()
    seat.loop.archive.add_interrupted(seat.path)
    (abandoned,) = seat.delivered()
    assert isinstance(abandoned, AbortedTrial)
    assert (abandoned.trial_id, abandoned.task, abandoned.number) == (drill.trial_id, "decide", 1)
    assert (abandoned.elapsed_s, abandoned.reason) == (pytest.approx(12.5), "abandoned")
    assert abandoned.is_kept
    assert not abandoned.counts_as_failed
    assert seat.history.left_drills("P01") == []
    assert TrialArchive(seat.folder).unacknowledged() == (abandoned,)
    seat.loop.archive.add_interrupted(seat.path)
    assert len(read_journal(seat.path).of_kind("attempt")) == 1
