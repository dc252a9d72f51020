"""Where a study is: a path, or an address of PostgreSQL, without password and over TLS."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database import postgres_connecting, postgres_database
from rastrainer.study.database.database import (
    LockWait,
    PostgresAddress,
    StudyUnreachableError,
    study_place,
)
from rastrainer.study.database.postgres_connecting import postgres_error
from rastrainer.study.database.study import Study
from rastrainer_simulator.cli.main import main

SECRET = "hunter2"
ADDRESS = study_place("postgresql://host/study")


@pytest.mark.parametrize(
    ("text", "host", "database", "sslmode"),
    [
        ("postgresql://seat@db.lab/study", "db.lab", "study", "verify-full"),
        ("postgres://localhost/study", "localhost", "study", None),
        ("postgresql://[::1]:5433/study", "::1", "study", None),
        ("postgresql://s%40t@db.lab/a%20b?sslmode=verify-ca", "db.lab", "a b", "verify-ca"),
        ("postgresql:///study?host=/run/pg&port=5433", "/run/pg", "study", None),
    ],
    ids=["usual", "short-scheme", "ipv6", "quoted", "socket"],
)
def test_an_address_is_read_and_another_computer_reached_over_tls(text, host, database, sslmode):
    assert study_place(text) == PostgresAddress(text, host, database, sslmode)
    assert study_place(str(study_place(text))) == study_place(text)
    assert study_place("study.db") == Path("study.db")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (f"postgresql://seat:{SECRET}@host/study", "must not hold a password"),
        (f"postgresql://host/study?password={SECRET}", "must not hold a password"),
        (f"postgresql://host/study?sslpassword={SECRET}", "may have each of"),
        ("postgresql://host/study?port=1&port=2", "may have each of"),
        ("postgresql://host", "names a host and a database"),
        ("postgresql://a,b/study", "names a host and a database"),
        ("postgresql://host:99999/study", "looks like"),
        ("postgresql://host/study\n", "printable text"),
        ("postgresql://host/study?sslmode=disable", "over TLS"),
        ("postgresql://localhost.evil.org/study?sslmode=prefer", "over TLS"),
    ],
)
def test_an_unusable_address_is_refused_without_being_repeated(text, words):
    with pytest.raises(InputError, match=words) as caught:
        study_place(text)
    assert SECRET not in str(caught.value)
    assert text not in str(caught.value)


def test_a_command_never_shows_the_password_in_its_address(capsys):
    assert main(["report", f"postgresql://seat:{SECRET}@host/study", "-o", "out"]) == 2
    text = "".join(capsys.readouterr())
    assert "must not hold a password" in text
    assert SECRET not in text


def test_opening_a_study_by_address_without_the_driver_says_what_is_missing(monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(postgres_connecting.importlib, "import_module", missing)
    with pytest.raises(InputError, match="needs the package psycopg, which comes with the sim"):
        Study.open("postgresql://localhost/study")


def test_only_the_driver_is_imported_from_the_simulators_folder(tmp_path, monkeypatch):
    folder = tmp_path / "simulator"
    folder.mkdir()
    (folder / "psycopg.py").write_text("ORIGIN = 'simulator'")
    (folder / "other_of_simulator.py").write_text("")
    monkeypatch.setattr(postgres_connecting, "_folders", [])
    for name in [name for name in postgres_connecting.sys.modules if name.startswith("psycopg")]:
        monkeypatch.delitem(postgres_connecting.sys.modules, name)
    elsewhere = [entry for entry in postgres_connecting.sys.path if "site-packages" not in entry]
    monkeypatch.setattr(postgres_connecting.sys, "path", elsewhere)
    postgres_connecting.find_driver_in(folder)
    assert postgres_connecting.postgres_driver().ORIGIN == "simulator"
    assert postgres_connecting.sys.path == elsewhere
    with pytest.raises(ImportError):
        __import__("other_of_simulator")
    del postgres_connecting.sys.modules["psycopg"]


def test_a_window_does_not_wait_for_a_silent_server_and_pauses_before_retrying(monkeypatch):
    monkeypatch.setattr(postgres_database, "INTERACTIVE_PATIENCE_S", 0.01)
    lock_wait = LockWait(0.05, rest_s=1.0, clock=lambda: 0.0)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"postgresql://seat@127.0.0.1:{server.getsockname()[1]}/study"
        with pytest.raises(StudyUnreachableError, match="cannot be reached now"):
            Study.open(address, lock_wait)
    assert lock_wait.timeout_s == 0.0
    monkeypatch.setattr(postgres_database, "connected_within", None)
    with pytest.raises(StudyUnreachableError, match="cannot be reached now"):
        Study.open(address, lock_wait)


class OperationalError(Exception):
    """Has the name of psycopg's error."""

    sqlstate = None


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('FATAL: password authentication failed for user "s"', "refuses"),
        ("SSL error: certificate verify failed", "somebody else may be"),
        ('certificate for "b" does not match host name "a"', "another computer"),
        ('FATAL:  database "x" does not exist', "no such database"),
        ("connection refused", "cannot be reached now"),
    ],
    ids=["user", "certificate", "name", "database", "away"],
)
def test_an_error_of_the_server_becomes_one_sentence(text, words):
    assert words in str(postgres_error(OperationalError(text), ADDRESS))
