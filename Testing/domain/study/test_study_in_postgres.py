"""A study in PostgreSQL with concurrent seats, kills, locks, hostile rows, and copies of it."""

from __future__ import annotations

import random
import subprocess
import sys
import threading
import time

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.database import LockWait, StudyUnreachableError
from rastrainer.study.database.schema import TABLES
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.ratings import FORMS, RatingStore
from rastrainer.trial.analysis import RevealedTruth
from rastrainer_simulator.cli.main import main
from Testing.domain.study.played_study import STUDIES, study_with_trials
from Testing.domain.study.study_content import rows_of, written_files
from Testing.domain.study.writers import Writer, stored_numbers
from Testing.domain.trial.trial_records import make_aborted, make_record
from Testing.postgres_server import PostgresServer, opened_when_available

pytestmark = pytest.mark.soak


@pytest.fixture
def place(postgres_server):
    return postgres_server.new_study()


@pytest.fixture
def own_server():
    """A server that the test may kill."""
    with PostgresServer() as server:
        yield server


def test_seats_that_begin_a_study_at_the_same_time_create_it_once(place):
    for process in [Writer(place, number, number + 1) for number in range(4)]:
        process.finish()
    assert stored_numbers(place) == [0, 1, 2, 3]


def test_a_server_killed_while_trials_are_stored_loses_none_that_were_acknowledged(own_server):
    place, rng = own_server.new_study(), random.Random(6)
    acknowledged, away, number = [], 0, 0
    study, is_over = opened_when_available(place), threading.Event()

    def kill_occasionally():
        for _ in range(10):
            time.sleep(rng.uniform(0.1, 0.4))
            own_server.kill()
            own_server.start()
        is_over.set()

    killer = threading.Thread(target=kill_occasionally)
    killer.start()
    while not is_over.is_set() or number < 10:
        record = make_record(number)
        try:
            study.add_trial(record)
        except StudyUnreachableError:
            away += 1
            continue
        acknowledged.append(number)
        number += 1
    killer.join()
    study.close()
    assert away
    assert stored_numbers(place) == acknowledged


class LostAnswer:
    """Commits what a seat has changed, and loses the connection before the seat hears of it."""

    def __init__(self, study):
        self.study = study

    def __enter__(self):
        connection = self.study.database._connection
        execute, driver = connection.execute, self.study.database._driver

        def lost(sql, *parameters):
            done = execute(sql, *parameters)
            if sql == "COMMIT":
                connection.close()
                raise driver.OperationalError("server closed the connection unexpectedly")
            return done

        connection.execute = lost

    def __exit__(self, *_exception):
        pass


def test_a_change_whose_answer_was_lost_is_stored_once_when_it_is_retried(place):
    trial, matrix = make_record()["trialId"], [float(n) for n in range(16)]
    with Study.open(place) as study:
        study.create_trainee("A")
        progress, ratings = StudyProgress(study), RatingStore(study)
        progress.set_protocol(StudyProtocol.read(STUDIES / "published-protocol.json"))
        form, mark_id = FORMS["gears"], "00000000-0000-0000-0000-0000000000aa"
        domain = form.domains[0].name
        changes = {
            "enroll": lambda: progress.enroll("A"),
            "trial": lambda: study.add_trial(make_record()),
            "truth": lambda: study.add_results(trial, truth=RevealedTruth(tuple(matrix), 0.5)),
            "aborted": lambda: study.add_aborted(make_aborted()),
            "assign": lambda: ratings.assign("R1", [trial], 1, random.Random(1)),
            "mark": lambda: ratings.give(mark_id, "R1", trial, form, domain, 4),
        }
        for change in changes.values():
            with LostAnswer(study), pytest.raises(StudyUnreachableError):
                change()
            before = counts_of(study.database)
            change()
            assert counts_of(study.database) == before
        assert len(study.history("T-001")) == 1
        assert ratings.marks("R1", trial) == {domain: 4}


def counts_of(database):
    return [database.row(f"SELECT count(*) FROM {table.name}") for table in TABLES.values()]


STOPPED = """
import os, signal, sys
from rastrainer.study.database.study import Study
study = Study.open(sys.argv[1])
with study.database.writing():
    print("locked", flush=True)
    os.kill(os.getpid(), signal.SIGSTOP)
"""


def test_a_seat_that_hangs_during_a_change_does_not_block_others_forever(place):
    Study.open(place).close()
    command = [sys.executable, "-c", STOPPED, str(place)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as stopped:
        assert stopped.stdout.readline() == "locked\n"
        with Study.open(place, LockWait(600.0)) as study:
            assert study.create_trainee("a")
        stopped.kill()


def test_a_study_that_is_only_read_is_never_changed(place, postgres_server):
    for options in ({"must_exist": True}, {}):
        with pytest.raises(InputError, match="holds no study"):
            (Study.open if options else Study.open_for_reading)(place, **options)
    tables = "SELECT count(*) FROM pg_tables WHERE schemaname = 'public'"
    assert postgres_server.execute(tables, place.database) == "0"
    study_with_trials(place)
    postgres_server.execute(
        "CREATE ROLE reader LOGIN; GRANT SELECT ON ALL TABLES IN SCHEMA public TO reader",
        place.database,
    )
    reader = postgres_server.address(place.database, "reader")
    for opened, words in (
        (Study.open_for_reading(place), "read-only"),
        (Study.open(reader), "may not do this"),
    ):
        with opened as study:
            assert study.history("A")
            with pytest.raises(InputError, match=words):
                study.create_trainee("C")


@pytest.mark.parametrize(
    ("sql", "words", "is_study"),
    [
        ("CREATE TABLE recipes (name TEXT)", "database of another program", False),
        ("CREATE VIEW trials AS SELECT 1", "contains triggers, views", False),
        ("ALTER TABLE trials ENABLE ROW LEVEL SECURITY; CREATE POLICY p ON trials USING (false)",
         "contains triggers", True),
        ("CREATE FUNCTION f() RETURNS trigger AS 'BEGIN RETURN NULL; END' LANGUAGE plpgsql; "
         "CREATE TRIGGER t BEFORE INSERT ON trials FOR EACH ROW EXECUTE FUNCTION f()",
         "contains triggers", True),
        ("UPDATE rastrainer_study SET user_version = 99", "has version 99 of the tables", True),
    ],
    ids=["other", "view", "policy", "trigger", "other version"],
)  # fmt: skip
def test_a_database_that_is_no_study_or_was_changed_is_refused_and_left_as_it_is(
    sql, words, is_study, place, postgres_server
):
    if is_study:
        Study.open(place).close()
    postgres_server.execute(sql, place.database)
    dump = "SELECT string_agg(relname, ',' ORDER BY relname) FROM pg_class WHERE relkind IN ('r', 'v') AND relnamespace = 'public'::regnamespace"  # noqa: E501
    before = postgres_server.execute(dump, place.database)
    with pytest.raises(InputError, match=words):
        Study.open(place)
    assert postgres_server.execute(dump, place.database) == before


def test_a_study_is_copied_there_and_back_to_the_last_bit(place, tmp_path, capsys):
    file, back = tmp_path / "study.db", tmp_path / "back.db"
    study_with_trials(file)
    with Study.open(file) as study:
        study.create_trainee("gone")
        study.delete_trainee("gone")
    assert main(["copy-study", str(file), str(place)]) == 0
    assert "2 trainees, " in capsys.readouterr().out
    assert main(["copy-study", str(place), str(back)]) == 0
    capsys.readouterr()
    assert main(["copy-study", str(file), str(place)]) == 2
    assert "holds something; choose an empty one" in capsys.readouterr().err
    assert rows_of(file) == rows_of(place) == rows_of(back)
    reports = [written_files(each, tmp_path / name) for name, each in
               (("a", file), ("b", place), ("c", back))]  # fmt: skip
    assert reports[0] == reports[1] == reports[2]
    assert len(reports[0]) > 10
    for each in (place, back):
        with Study.open(each) as study:
            assert study.create_trainee().pseudonym == "T004"
            assert study.add_trial(make_record(trainee="A"))
            study.add_results(make_record()["trialId"], [])


def test_a_server_that_could_lose_what_it_acknowledged_is_refused(own_server):
    place = own_server.new_study()
    own_server.execute("ALTER SYSTEM SET fsync = off")
    own_server.kill()
    own_server.start()
    with pytest.raises(InputError, match="fsync = off"):
        Study.open(place)


def test_a_password_is_found_in_its_file_and_shown_nowhere(own_server, tmp_path):
    place = own_server.new_study()
    own_server.execute("CREATE ROLE seat LOGIN PASSWORD 'hunter2'")
    own_server.execute(
        f"GRANT ALL ON SCHEMA public TO seat; ALTER DATABASE {place.database} OWNER TO seat",
        place.database,
    )
    own_server.ask_for_passwords()
    script = "import sys; from rastrainer_simulator.cli.main import main; sys.exit(main())"
    words = [sys.executable, "-c", script, "copy-study", str(tmp_path / "study.db")]
    words.append(str(own_server.address(place.database, "seat")))
    study_with_trials(tmp_path / "study.db")
    passwords = tmp_path / "pgpass"
    environment = {"PGPASSFILE": str(passwords), "PATH": "/usr/bin", "HOME": str(tmp_path)}

    def output():
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
        assert "hunter" not in done.stdout + done.stderr
        return done.stdout + done.stderr

    assert "asks for a password; put it into ~/.pgpass" in output()
    passwords.write_text(f"127.0.0.1:{own_server.port}:*:seat:hunter3\n")
    passwords.chmod(0o600)
    assert "refuses this user" in output()
    passwords.write_text(f"127.0.0.1:{own_server.port}:*:seat:hunter2\n")
    assert "each compared with its original" in output()


def test_another_computer_is_reached_only_over_tls(own_server, tmp_path):
    place = own_server.new_study()
    # A loopback number outside our list is treated as another computer.
    far = f"postgresql://tester@127.0.0.2:{own_server.port}/{place.database}"
    with pytest.raises(InputError, match=r"does not offer TLS|sslrootcert"):
        Study.open(far)
    certificate = own_server.offer_tls(tmp_path, "127.0.0.2")
    with Study.open(f"{far}?sslrootcert={certificate}") as study:
        assert study.create_trainee("a")
    other = own_server.offer_tls(tmp_path, "127.0.0.3")
    with pytest.raises(InputError, match="belongs to another computer: somebody else"):
        Study.open(f"{far}?sslrootcert={other}")
    with pytest.raises(InputError, match="not from the expected issuer"):
        Study.open(f"{far}?sslrootcert={certificate}")
