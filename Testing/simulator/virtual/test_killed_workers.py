"""A worker process that is killed costs another attempt, and never the cohort."""

import functools
import json
import os
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_protocol import StudyProtocol, protocol_text
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.virtual.cohort import (
    ATTEMPTS,
    DATABASE,
    RECORDS,
    run_jobs,
    simulate_cohort,
)
from rastrainer_simulator.virtual.play import PlaySettings
from Testing.running_process import runs, started_by
from Testing.simulator.report.without_charts import without_charts
from Testing.simulator.virtual.small_jobs import refused, squared_by_mortals

STORED_WHEN = {"stored_utc", "created_utc", "finished_utc"}


def tables(path):
    """Return all rows of a study except when they were stored."""
    connection = sqlite3.connect(path)
    connection.row_factory = sqlite3.Row
    names = [row[0] for row in connection.execute("SELECT name FROM sqlite_master")]
    found = {}
    for name in sorted(name for name in names if not name.startswith(("sqlite_", "trials_of"))):
        try:
            rows = connection.execute(f"SELECT * FROM {name}").fetchall()
        except sqlite3.OperationalError:
            continue  # an index
        found[name] = [
            [row[key] for key in row.keys() if key not in STORED_WHEN]  # noqa: SIM118
            for row in rows
        ]
    connection.close()
    return found


def journals(folder):
    """Return the entries of all journals without the time of writing, which is in the hashes."""
    clock = ("monotonicS", "previous", "sha256")
    found = {}
    for path in (folder / RECORDS).iterdir():
        entries = [json.loads(line) for line in path.read_text().splitlines()]
        found[path.name] = [{k: v for k, v in one.items() if k not in clock} for one in entries]
    return found


def without_last_trials(folder, count):
    """Undo the last trials of a cohort, as if it had been interrupted before them."""
    connection = sqlite3.connect(folder / DATABASE)
    connection.execute("PRAGMA foreign_keys = ON")
    last = "(SELECT trial_id FROM trials ORDER BY rowid DESC LIMIT ?)"
    connection.execute(f"DELETE FROM trials WHERE trial_id IN {last}", (count,))
    empty = "SELECT trainee_id FROM trials"
    connection.execute(f"DELETE FROM trainees WHERE id NOT IN ({empty})")
    connection.execute("UPDATE sqlite_sequence SET seq = (SELECT max(id) FROM trainees)")
    connection.execute("UPDATE trainee_numbers SET latest = (SELECT max(id) FROM trainees)")
    connection.execute("UPDATE cohort SET finished_utc = NULL")
    connection.commit()
    connection.close()


def test_the_job_of_a_killed_worker_is_done_by_another_one(tmp_path):
    function = functools.partial(squared_by_mortals, tmp_path, {3}, ATTEMPTS - 1)
    found = list(run_jobs(function, range(12), workers=2))
    assert found == [number * number for number in range(12)]
    assert len(list(tmp_path.iterdir())) == ATTEMPTS - 1


def test_a_job_that_kills_every_worker_ends_the_run(tmp_path):
    function = functools.partial(squared_by_mortals, tmp_path, {4}, ATTEMPTS + 1)
    results = run_jobs(function, range(99), workers=2)
    assert [next(results) for _ in range(4)] == [0, 1, 4, 9]
    with pytest.raises(InputError, match=r"killed 3 times.*the same command resumes"):
        next(results)
    assert not any(map(is_worker, started_by(os.getpid())))


def is_worker(pid):
    return b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes()


def test_an_error_in_a_worker_is_raised_and_no_worker_is_left():
    with pytest.raises(ZeroDivisionError, match="not 0"):
        list(run_jobs(refused, range(3), workers=2))
    assert not any(map(is_worker, started_by(os.getpid())))


@pytest.mark.parametrize("missing", [1, pytest.param(3, marks=pytest.mark.soak)])
def test_a_resumed_cohort_equals_an_uninterrupted_one_to_the_last_bit(
    missing, played, copied, protocol, population
):
    without_last_trials(copied, missing)
    assert tables(copied / DATABASE) != tables(played / DATABASE)
    words = (protocol, population, 2, 7, copied, PlaySettings(), True)
    run = simulate_cohort(*words, workers=1)
    assert (run.found, run.played) == (4 - missing, missing)
    assert tables(copied / DATABASE) == tables(played / DATABASE)
    assert journals(copied) == journals(played)


def test_a_cohort_is_resumed_only_with_its_own_options(copied, protocol, population):
    settings = PlaySettings(step_s=0.04)
    with pytest.raises(ValueError, match=r"with other options \(different: seed, step\)"):
        simulate_cohort(protocol, population, 2, 8, copied, settings, True, workers=1)


def test_a_study_of_people_is_never_resumed_as_a_cohort(tmp_path, protocol, population):
    with Study.open(tmp_path / DATABASE) as study:
        study.create_trainee("A-1")
    with pytest.raises(ValueError, match="no virtual cohort"):
        simulate_cohort(protocol, population, 2, 7, tmp_path, PlaySettings(), workers=1)
    with Study.open(tmp_path / DATABASE) as study:
        assert [trainee.pseudonym for trainee in study.trainees()] == ["A-1"]


def test_an_incomplete_cohort_is_reported_and_exported_only_on_request(copied, tmp_path, capsys):
    without_last_trials(copied, 1)
    for command in ("report", "export"):
        words = [command, str(copied / DATABASE), "-o", str(tmp_path / command)]
        assert main(words) == 2
        errors = capsys.readouterr().err
        assert "is incomplete: 3 of 4 trials are stored." in errors
        assert not (tmp_path / command).exists()
    words = ["report", str(copied / DATABASE), "-o", str(tmp_path / "page"), "--incomplete"]
    with without_charts():
        assert main(words) == 0
    page = (tmp_path / "page" / "report.html").read_text()
    assert "3 of 4 trials are stored. What follows is about these trials alone." in page


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The command without its folder, and a cohort that nothing interrupted."""
    folder = tmp_path_factory.mktemp("whole")
    small = StudyProtocol("s", "S", ("desktop",), "fixed", ("task-1",), "fixed")
    (folder / "small.json").write_text(protocol_text(small))
    words = ["simulate-cohort", "--trainees", "5", "--protocol", str(folder / "small.json")]
    words += ["--speed", "300", "--seed", "5"]
    assert main([*words, "--workers", "1", "-o", str(folder / "study")]) == 0
    return words, tables(folder / "study" / DATABASE)


@pytest.mark.soak
@pytest.mark.parametrize("stop", [signal.SIGINT, signal.SIGKILL])
def test_a_stopped_command_leaves_a_study_that_the_same_command_resumes(
    stop, whole, tmp_path, capsys
):
    """The signal reaches the process group, as Ctrl-C in a terminal does."""
    folder = tmp_path / "study"
    words = [*whole[0], "-o", str(folder)]
    command = [sys.executable, "-m", "rastrainer_simulator.cli.main", *words, "--workers", "2"]
    process = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        start_new_session=True,
        # A shell that runs the tests in the background has them ignore Ctrl-C.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )
    while trials_in(folder) == 0:
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    workers = started_by(process.pid)
    if stop == signal.SIGINT:
        os.killpg(process.pid, stop)
    else:
        os.kill(process.pid, stop)
    _out, errors = process.communicate()
    assert "Traceback" not in errors
    if stop == signal.SIGINT:
        assert process.returncode == 130
        assert errors.strip().endswith("the same command resumes.")
    while any(map(runs, workers)):
        time.sleep(0.02)
    assert trials_in(folder) < 5
    assert main([*words, "--workers", "1"]) == 0
    assert "trials were stored before; " in capsys.readouterr().out
    assert tables(folder / DATABASE) == whole[1]


def trials_in(folder):
    if not (folder / DATABASE).exists():
        return 0
    connection = sqlite3.connect(folder / DATABASE)
    try:
        return connection.execute("SELECT count(*) FROM trials").fetchone()[0]
    except sqlite3.OperationalError:
        return 0
    finally:
        connection.close()
