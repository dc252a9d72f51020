"""Reading a study changes neither its rows nor its bytes nor its modification time."""

import os
import shutil
import signal
import subprocess
import sys

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer_simulator.cli.main import main
from Testing.domain.study.played_study import play, study_with_trials
from Testing.domain.trial.trial_records import make_record
from Testing.simulator.report.without_charts import without_charts


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A study with a stored trial of B that is not counted yet."""
    path = tmp_path_factory.mktemp("played") / "study.db"
    study_with_trials(path)
    with Study.open(path) as study:
        play(study, "B", "desktop")
    return path


@pytest.fixture
def path(played, tmp_path):
    path = tmp_path / "study" / "study.db"
    path.parent.mkdir()
    shutil.copy(played, path)
    os.utime(path, (1_000_000_000, 1_000_000_000))
    return path


def seen(path):
    """The files with bytes and times, which any write would change."""
    return {
        each.name: (each.read_bytes(), each.stat().st_mtime_ns) for each in path.parent.iterdir()
    }


@pytest.mark.parametrize(
    "words",
    [
        pytest.param(("report", "STUDY", "-o", "OUT"), id="report"),
        pytest.param(("export", "STUDY", "-o", "OUT"), id="export"),
    ],
)
def test_a_study_in_mid_protocol_keeps_its_bytes_and_its_mtime(path, tmp_path, words, capsys):
    before = seen(path)
    known = {"STUDY": path, "OUT": tmp_path / "out"}
    with without_charts():
        assert main([str(known.get(word, word)) for word in words]) == 0
    assert seen(path) == before
    assert capsys.readouterr().out


def test_reading_shows_played_steps_without_storing_them(path):
    with Study.open_for_reading(path) as study:
        progress = StudyProgress(study)
        stored, played = progress.progress("B"), progress.played("B")
        assert progress.progress("B") == stored
    with Study.open(path) as study:
        counted = StudyProgress(study).count_played("B")
    assert [entry.details for entry in played.entries] == [e.details for e in counted.entries]
    assert played.next_step == counted.next_step


def test_a_study_opened_for_reading_cannot_be_changed(path):
    before = seen(path)
    with Study.open_for_reading(path) as study:
        with pytest.raises(InputError, match="read-only"):
            study.create_trainee("C")
        with pytest.raises(InputError, match="read-only"):
            study.add_trial(make_record(999))
    assert seen(path) == before


KILLED = """
import os, signal, sqlite3, sys
connection = sqlite3.connect(sys.argv[1], isolation_level=None)
connection.execute("PRAGMA cache_size = 1")
connection.execute("BEGIN IMMEDIATE")
connection.execute("UPDATE trainees SET pseudonym = pseudonym || 'x'")
connection.execute("CREATE TABLE further AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL "
                   "SELECT i + 1 FROM n WHERE i < 20000) SELECT i, hex(randomblob(64)) FROM n")
os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="kills by a signal")
def test_a_study_whose_writer_was_killed_is_read_as_before_its_change(path):
    with Study.open(path) as study:
        names = [trainee.pseudonym for trainee in study.trainees()]
    killed = subprocess.run([sys.executable, "-c", KILLED, path], check=False)
    assert killed.returncode == -signal.SIGKILL
    assert path.with_name("study.db-journal").stat().st_size > 0
    with Study.open_for_reading(path) as study:
        assert [trainee.pseudonym for trainee in study.trainees()] == names


def test_a_study_with_uri_characters_in_its_name_is_read(path):
    odd = path.with_name("s?mode=rwc#%41.db")
    shutil.copy(path, odd)
    with Study.open_for_reading(odd) as study:
        assert study.trainees()
