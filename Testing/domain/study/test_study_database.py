"""The study's file with concurrent processes, kills, damage and foreign files."""

import contextlib
import os
import random
import re
import resource
import sqlite3
import tempfile
import time
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.database import LockWait, StudyBusyError
from rastrainer.study.database.postgres_database import in_postgres
from rastrainer.study.database.schema import STATEMENTS, TABLES
from rastrainer.study.database.study import Study
from Testing.domain.study.writers import Writer, stored_numbers
from Testing.domain.trial.trial_records import make_record
from Testing.forked_child import in_child


def check(path):
    if not isinstance(path, Path):
        return "ok"
    connection = sqlite3.connect(path)
    try:
        return connection.execute("PRAGMA integrity_check").fetchone()[0]
    finally:
        connection.close()


def test_changes_within_a_transaction_are_part_of_it(study_place):
    with Study.open(study_place) as study, Study.open(study_place) as other:
        with contextlib.suppress(ZeroDivisionError), study.database.writing():
            study.create_trainee("A")
            assert study.trainee("A").pseudonym == "A"
            raise ZeroDivisionError
        with pytest.raises(AttributeError):
            study.add_trial(make_record(), registrations=[None])
        assert study.trainees() == ()
        with study.database.writing():
            study.create_trainee("B")
            assert other.trainees() == ()
        assert [trainee.pseudonym for trainee in other.trainees()] == ["B"]
        with pytest.raises(RuntimeError, match="for reading"), study.database.reading():
            study.create_trainee("A")


@pytest.mark.parametrize("wanted", [5, pytest.param(400, marks=pytest.mark.soak)])
def test_killed_writers_lose_and_duplicate_nothing(study_place, wanted):
    path = study_place
    rng = random.Random(5)
    acknowledged, kills, longest_s = set(), 0, 0.08
    writers = [Writer(path, 0), Writer(path, 0)]
    while kills < wanted or len(acknowledged) <= wanted:
        time.sleep(rng.uniform(0.0, longest_s))
        victim = rng.randrange(2)
        acknowledged |= writers[victim].kill()
        kills += 1
        # A slow machine or server gets more time.
        longest_s *= 1.0 if len(acknowledged) > kills else 1.1
        # Both start near the same number, so that they race for the same trials.
        first = max(0, max(acknowledged, default=0) - rng.randrange(4))
        writers[victim] = Writer(path, first)
    for process in writers:
        acknowledged |= process.kill()
    stored = stored_numbers(path)
    assert acknowledged <= set(stored)
    assert len(stored) == len(set(stored))
    assert check(path) == "ok"


def of_another_program():
    with contextlib.closing(sqlite3.connect(":memory:")) as connection:
        connection.execute("CREATE TABLE recipes (name TEXT)")
        return connection.serialize()


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"This is a letter to a friend, not a database at all." * 40, "is not a study database"),
        (b"SQLite format 3\0" + b"\xff" * 4096, "is not a study database|is damaged"),
        (b"\0" * 5000, "is not a study database"),
        (of_another_program(), "the database of another program"),
    ],
    ids=["letter", "header", "zeros", "other"],
)
def test_a_file_that_is_no_study_is_refused_and_left_unchanged(content, words, tmp_path):
    path = tmp_path / "file"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        Study.open(path)
    assert path.read_bytes() == content


@pytest.mark.parametrize("version", [2])
def test_a_study_of_another_version_is_refused_and_left_unchanged(version, tmp_path):
    path = tmp_path / "study.db"
    with Study.open(path) as study:
        study.create_trainee("A")
    connection = sqlite3.connect(path)
    connection.execute(f"PRAGMA user_version = {version}")
    connection.close()
    before = path.read_bytes()
    for opened in (Study.open, Study.open_for_reading):
        with pytest.raises(InputError, match=rf"has version {version} of the tables.* left as"):
            opened(path)
    assert path.read_bytes() == before


def test_a_damaged_study_is_reported(tmp_path):
    path = tmp_path / "study.db"
    with Study.open(path) as study:
        for number in range(40):
            study.add_trial(make_record(number))
    content = bytearray(path.read_bytes())
    for start in range(4096, len(content), 4096):
        content[start : start + 300] = b"\xaa" * 300
    path.write_bytes(content)
    with pytest.raises(InputError, match="is damaged; restore it from a backup"):
        Study.open(path)


@pytest.mark.parametrize(
    "change",
    ["'[1]'", """replace(record_json, '{', '{"a": NaN, ')""", "replace(record_json, '{', '[')"],
)
def test_a_foreign_value_is_reported(tmp_path, change):
    path = tmp_path / "study.db"
    with Study.open(path) as study:
        study.add_trial(make_record())
    connection = sqlite3.connect(path)
    connection.execute(f"UPDATE trials SET record_json = {change}")
    connection.commit()
    connection.close()
    with Study.open(path) as study, pytest.raises(InputError, match="did not write"):
        study.trial(make_record()["trialId"])


@pytest.mark.parametrize(
    ("name", "words"),
    [("", "is a folder"), ("missing/study.db", "no folder"), ("a\0b", "null character")],
)
def test_an_unusable_path_is_reported(name, words, tmp_path):
    with pytest.raises(InputError, match=words):
        Study.open(f"{tmp_path}/{name}")


def use_without_permission(path):
    if os.getuid() == 0:
        os.setuid(65534)
    try:
        with Study.open(path) as study:
            trials = len(study.history("T-001"))
            study.create_trainee("b")
    except InputError as error:
        return trials, str(error)
    return trials, "written"


def test_a_read_only_study_can_be_read_and_reports_failed_writes():
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "study.db")
        with Study.open(path) as study:
            study.add_trial(make_record())
        path.chmod(0o444)
        Path(folder).chmod(0o555)
        trials, sentence = in_child(use_without_permission, path)
        Path(folder).chmod(0o755)
    assert trials == 1
    assert sentence == f"The study {path} is read-only; allow writing to it and its folder."


def fill_disk(path):
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 4096,) * 2)
    stored = 0
    try:
        with Study.open(path) as study:
            for number in range(100):
                study.add_trial(make_record(number))
                stored += 1
    except InputError as error:
        return stored, str(error)
    return stored, "written"


def test_a_full_disk_is_reported_and_stored_data_remain(tmp_path):
    path = tmp_path / "study.db"
    Study.open(path).close()
    stored, sentence = in_child(fill_disk, path)
    assert "cannot be written: the disk is full" in sentence or "the disk has errors" in sentence
    with Study.open(path) as study:
        trainees = study.trainees()
        assert sum(len(study.history(t.pseudonym)) for t in trainees) == stored


class CountedLockWait(LockWait):
    """Records how long SQLite may wait each time."""

    def __init__(self):
        super().__init__(0.05, rest_s=1.0, clock=lambda: self.now)
        self.now = 0.0
        self.allowed = []

    @property
    def timeout_s(self):
        self.allowed.append(super().timeout_s)
        return self.allowed[-1]


def test_a_window_reports_a_lock_waits_only_once_for_it_and_goes_on_afterward(tmp_path):
    path, lock_wait = tmp_path / "study.db", CountedLockWait()
    with Study.open(path, lock_wait) as study:
        other = sqlite3.connect(path, isolation_level=None)
        other.execute("BEGIN EXCLUSIVE")
        lock_wait.allowed.clear()
        for ask in (study.trainees, lambda: Study.open(path, lock_wait)) * 3:
            with pytest.raises(StudyBusyError, match=r"program has locked the study .*; try again"):
                ask()
        assert sum(lock_wait.allowed) == 0.05
        lock_wait.now = 1.5
        with pytest.raises(StudyBusyError):
            study.trainees()
        assert sum(lock_wait.allowed) == 0.1
        other.execute("ROLLBACK")
        other.close()
        assert study.create_trainee("a").pseudonym == "a"


def test_the_tables_and_columns_match_those_that_sqlite_makes_from_the_schema(tmp_path):
    path = tmp_path / "study.db"
    Study.open(path).close()
    connection = sqlite3.connect(path)
    made = {
        name: [row[1] for row in connection.execute(f"PRAGMA table_info({name})")]
        for (name,) in connection.execute(
            "SELECT name FROM sqlite_master WHERE type = 'table' AND name != 'sqlite_sequence'"
        )
    }
    for table in TABLES.values():
        assert made.pop(table.name) == list(table.columns)
        assert connection.execute(f"SELECT {table.order} FROM {table.name}").fetchall() is not None
    connection.close()
    assert not made


def test_nothing_specific_to_sqlite_is_left():
    translated = " ".join(map(in_postgres, STATEMENTS))
    assert not re.search(r"\b(INTEGER|REAL|AUTOINCREMENT|ROWID)\b", translated)
