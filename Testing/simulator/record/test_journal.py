"""The journal of a trial: nothing lost, nothing altered unnoticed."""

import subprocess
import sys

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import (
    FORMAT,
    FORMAT_VERSION,
    Integrity,
    read_journal,
)
from rastrainer_simulator.record.journal_writer import Journal, RecordError

HEADER = {"kind": "header", "format": FORMAT, "version": FORMAT_VERSION, "trialId": "T"}
TRIAL = [
    HEADER,
    {"kind": "touch", "label": "1", "positionMm": [1.5, -2.25, 1e-17]},
    {"kind": "sample", "q": [0.1] * 7, "note": "é × –"},
    {"kind": "registered", "record": {"points": []}},
]


@pytest.fixture
def written(tmp_path):
    path = tmp_path / "trial.journal"
    journal = Journal(path)
    journal.write(TRIAL[:2], sync=True)
    journal.write(TRIAL[2:], sync=True)
    journal.close()
    return path


def without_chain(entries):
    return [{k: v for k, v in e.items() if k not in ("n", "previous", "sha256")} for e in entries]


def test_a_line_can_be_checked_with_any_sha256_tool(written):
    line = written.read_text().splitlines()[1]
    body, seal = line.split(',"sha256":"')
    computed = subprocess.run(
        ["sha256sum"], input=(body + "}").encode(), capture_output=True, check=True
    ).stdout.decode()
    assert computed.split()[0] == seal[:64]


def test_a_journal_cut_at_any_byte_is_recovered_up_to_the_last_complete_line(written, tmp_path):
    data = written.read_bytes()
    cut = tmp_path / "cut.journal"
    for size in range(len(data)):
        cut.write_bytes(data[:size])
        reading = read_journal(cut)
        assert reading.integrity is Integrity.CUT_SHORT, size
        assert len(reading.entries) == data[:size].count(b"\n")
        assert without_chain(reading.entries) == TRIAL[: len(reading.entries)]


def test_any_altered_byte_is_detected_and_its_line_named(written, tmp_path):
    data = written.read_bytes()
    altered = tmp_path / "altered.journal"
    starts = [0, *(i + 1 for i, byte in enumerate(data) if byte == 10)]
    for position in range(starts[1], len(data) - 1, 7):
        changed = bytearray(data)
        changed[position] ^= 1
        altered.write_bytes(changed)
        reading = read_journal(altered)
        line = sum(start <= position for start in starts)
        assert reading.integrity is Integrity.ALTERED
        assert f"line {line} " in reading.sentence
        assert len(reading.entries) == line - 1


def test_a_removed_swapped_or_forged_line_with_a_valid_hash_is_detected(written, tmp_path):
    lines = written.read_bytes().splitlines(keepends=True)
    forger = Journal(tmp_path / "forged.journal")
    forger.write([HEADER, {"kind": "touch", "label": "1", "positionMm": [9, 9, 9]}], sync=False)
    forged = forger.path.read_bytes().splitlines(keepends=True)[1]
    for tampered in (
        [lines[0], *lines[2:]],
        [lines[0], lines[2], lines[1], lines[3]],
        [lines[0], forged, *lines[2:]],
    ):
        path = tmp_path / "tampered.journal"
        path.write_bytes(b"".join(tampered))
        assert read_journal(path).integrity is Integrity.ALTERED


def test_a_file_that_is_not_a_journal_or_a_later_one_is_refused_with_a_message(tmp_path):
    path = tmp_path / "other.journal"
    for content in (b"hello\n", b'{"n":1}\n', b"\x00" * 500_000, b"[" * 100_000):
        path.write_bytes(content)
        with pytest.raises(InputError, match="is not a trial's journal"):
            read_journal(path)
    path.unlink()
    Journal(path).write([HEADER | {"version": 99}], sync=False)
    with pytest.raises(InputError, match="format version 99"):
        read_journal(path)


def test_a_line_without_an_end_is_refused_without_reading_all_of_it(written):
    with written.open("ab") as file:
        file.truncate(10_000_000_000)
    reading = read_journal(written)
    assert reading.integrity is Integrity.ALTERED
    assert "line 5 " in reading.sentence


def test_an_existing_file_is_never_overwritten(written):
    before = written.read_bytes()
    journal = Journal(written)
    with pytest.raises(RecordError, match="exists"):
        journal.write([HEADER], sync=True)
    journal.close()
    assert written.read_bytes() == before


def test_an_incomplete_line_is_cut_off_before_more_is_appended(written):
    with written.open("ab") as file:
        file.write(b'{"n":5,"prev')
    journal = Journal.reopened(read_journal(written))
    journal.write([{"kind": "acknowledged"}], sync=True)
    reading = read_journal(written)
    assert reading.integrity is Integrity.INTACT
    assert [entry["kind"] for entry in reading.entries[3:]] == ["registered", "acknowledged"]


def test_two_programs_write_to_one_journal_one_after_the_other_only(written):
    ours = Journal.reopened(read_journal(written))
    theirs = Journal.reopened(read_journal(written))
    theirs.write([{"kind": "scored"}], sync=True)
    theirs.close()
    ours.write([{"kind": "acknowledged"}], sync=True)
    reading = read_journal(written)
    assert [entry["kind"] for entry in reading.entries][-2:] == ["scored", "acknowledged"]
    with pytest.raises(RecordError):
        Journal.reopened(reading).write([{"kind": "acknowledged"}], sync=True)


def test_a_folder_that_cannot_be_created_is_reported_and_the_entries_are_kept(tmp_path, caplog):
    blocked = tmp_path / "records"
    blocked.write_text("a file where the folder should be")
    journal = Journal(blocked / "trial.journal")
    for new in (TRIAL[:2], []):
        with pytest.raises(RecordError):
            journal.write(new, sync=True)
    assert [record.message[:19] for record in caplog.records] == ["Nothing is recorded"]
    blocked.unlink()
    journal.write(TRIAL[2:], sync=True)
    assert without_chain(read_journal(journal.path).entries) == TRIAL


def test_a_full_disk_leaves_no_partial_line_and_everything_is_written_once_there_is_room(tmp_path):
    script = f"""
import resource, signal, sys
from pathlib import Path
from rastrainer_simulator.record.journal_writer import Journal, RecordError
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
journal = Journal(Path({str(tmp_path / "full.journal")!r}))
journal.write([{HEADER!r}], sync=True)
resource.setrlimit(resource.RLIMIT_FSIZE, (600, resource.RLIM_INFINITY))
entries = [{{"kind": "sample", "i": i}} for i in range(10)]
try:
    journal.write(entries, sync=True)
except RecordError as error:
    print(error)
print(journal.path.read_bytes().count(b"\\n"), journal.path.read_bytes()[-1:] == b"\\n")
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
journal.write([{{"kind": "aborted"}}], sync=True)
"""
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert done[0] == "full.journal: File too large"
    assert done[1] == "1 True"
    reading = read_journal(tmp_path / "full.journal")
    assert reading.integrity is Integrity.INTACT
    assert [e.get("i") for e in reading.entries[1:-1]] == list(range(10))
