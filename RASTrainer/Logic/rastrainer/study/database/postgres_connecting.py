"""Psycopg, its connections to PostgreSQL, and what its errors mean.

Psycopg is loaded only for a study in PostgreSQL, and installed with the simulator. Slicer's Python
runs the simulator, so its copy fits Slicer, too, and is loaded from the simulator's private folder:
nothing is installed into Slicer.

A connection keeps committed changes, and notices when the other side is gone.
"""

from __future__ import annotations

import importlib
import math
import sys
import threading
import time
from collections.abc import Generator
from concurrent.futures import Future, wait
from pathlib import Path
from types import ModuleType
from typing import Any

from rastrainer.errors import InputError
from rastrainer.study.database.database import (
    PostgresAddress,
    StudyBusyError,
    StudyUnreachableError,
)

_folders: list[Path] = []
"""Folder in which Psycopg is searched if this Python has none."""
CONNECT_TIMEOUT_S = 10
SILENCE_S = 10
"""Time after which a connection is given up if the other side no longer acknowledges data."""
INTERACTIVE_SILENCE_S = 2
ANSWER_S = 75
"""After which one is given up that confirms everything and answers nothing, as a server that hangs.

Longer than `statement_timeout`.
"""
INTERACTIVE_PATIENCE_S = 0.5
"""Limit for a window; the attempt continues without it."""
_SESSION = """
    SET search_path = public;
    SET timezone = 'UTC';
    SET synchronous_commit = on;
    SET statement_timeout = '60s';
    SET idle_in_transaction_session_timeout = '20s';
    SET tcp_keepalives_idle = 10;
    SET tcp_keepalives_interval = 5;
    SET tcp_keepalives_count = 3;
"""
"""A committed change survives a power failure, and a vanished seat blocks no one."""
_NETWORK = {"keepalives_idle": 10, "keepalives_interval": 5}
_Waiting = Generator[Any, int, Any]
_attempts: dict[str, Future[Any]] = {}
"""Connections that windows wait for, by address."""
_LOCKED = ("55P03", "57014", "40P01", "40001")
"""A lock, or a statement, that took too long; two that wait for each other."""
_LEFT = "25P03"
"""The server has ended a change that this program had stalled, such as a computer asleep."""
_OURS = ("23", "42")
"""Classes of errors that only our own bugs cause."""
_MAX_WORDS = 200

_BY_STATE = {
    "22": "The study contains a value that RASTrainer did not write, or was to store one.",
    "25006": "The study {0} is read-only.",
    "28": "The server of {0} refuses this user; check name, ~/.pgpass and pg_hba.conf.",
    "3D000": "The server of {0} has no such database; ask its administrator to create it.",
    "42501": "The user may not do this in {0}; make it the owner of the database.",
    "42P01": "The study {0} is damaged; restore it from a backup.",
    "42703": "The study {0} is damaged; restore it from a backup.",
    "53100": "The study {0} cannot be written: the disk of its server is full.",
    "XX": "The study {0} is damaged; restore it from a backup.",
    "58": "The study {0} cannot be read or written: the disk of its server has errors.",
}
_BY_WORDS = {
    "password authentication failed": _BY_STATE["28"],
    "no password supplied": (
        "The server of {0} asks for a password; put it into ~/.pgpass, readable by you alone."
    ),
    "pg_hba.conf": _BY_STATE["28"],
    "root certificate file": (
        "To check the certificate of {0}, its issuer's is needed: put it into "
        "~/.postgresql/root.crt, or name its file with sslrootcert."
    ),
    "certificate verify failed": (
        "The certificate of {0} is not from the expected issuer: somebody else may be answering."
    ),
    "does not match host name": (
        "The certificate of {0} belongs to another computer: somebody else may be answering."
    ),
    "does not support ssl": (
        "The server of {0} does not offer TLS, which a study on another computer needs; ask "
        "its administrator to switch ssl on."
    ),
    '" does not exist': "The server of {0} has no such database or user.",
    "permissions should be": (
        "A file of keys or passwords for {0} can be read by others; restrict it to yourself with "
        "chmod 600."
    ),
}


def find_driver_in(folder: Path) -> None:
    """Load the package from a private folder if this Python has none."""
    if folder not in _folders:
        _folders.append(folder)


def postgres_driver() -> ModuleType:
    searched = [str(folder) for folder in _folders if folder.is_dir()]
    # Last, and only meanwhile: nothing else in Slicer finds the simulator's packages.
    sys.path.extend(searched)
    try:
        return importlib.import_module("psycopg")
    except ImportError:
        raise InputError(
            "A study in PostgreSQL needs the package psycopg, which comes with the simulator: set "
            "the simulator up first, in the section Simulator."
        ) from None
    finally:
        for folder in searched:
            sys.path.remove(folder)


def _finite(_loader: Any, data: Any) -> float:
    value = float(bytes(data))
    if not math.isfinite(value):
        raise InputError("The study contains a value that RASTrainer did not write.")
    return value


def connected(
    address: PostgresAddress, silence_s: int = SILENCE_S, answer_s: float = ANSWER_S
) -> Any:
    """Return a connection; psycopg's error if there is none in time."""
    connection = _impatient(postgres_driver(), answer_s).connect(
        address.uri,
        # As they were checked.
        host=address.host,
        sslmode=address.sslmode,
        **_NETWORK,
        tcp_user_timeout=1000 * silence_s,
        autocommit=True,
        # For servers behind a pool of connections.
        prepare_threshold=None,
        application_name="RASTrainer",
        client_encoding="UTF8",
        connect_timeout=CONNECT_TIMEOUT_S,
    )
    base = importlib.import_module("psycopg.types.numeric").FloatLoader
    connection.adapters.register_loader("float8", type("FiniteLoader", (base,), {"load": _finite}))
    connection.execute(_SESSION)
    return connection


def connected_within(patience_s: float, address: PostgresAddress) -> Any:
    """Return a connection, or raise `TimeoutError` soon: the next call gets it if it has come."""
    key = str(address)
    if key not in _attempts:
        answer: Future[Any] = Future()

        def connect() -> None:
            try:
                answer.set_result(connected(address, INTERACTIVE_SILENCE_S, INTERACTIVE_SILENCE_S))
            except BaseException as error:
                answer.set_exception(error)

        threading.Thread(target=connect, name="study", daemon=True).start()
        _attempts[key] = answer
    attempt = _attempts[key]
    wait([attempt], patience_s)
    if not attempt.done():
        raise TimeoutError
    del _attempts[key]
    return attempt.result()


def _impatient(driver: ModuleType, answer_s: float) -> Any:
    """Return psycopg's class of connections, which waits forever, with a time limit."""

    def waits(self: Any, gen: _Waiting, *arguments: Any, **options: Any) -> Any:
        return driver.Connection.wait(self, answers(self, gen), *arguments, **options)

    def answers(self: Any, gen: _Waiting) -> _Waiting:
        try:
            wanted, until = next(gen), time.monotonic() + answer_s
            while True:
                ready = yield wanted
                if ready:
                    until = time.monotonic() + answer_s
                # Asked several times a second while nothing comes.
                elif time.monotonic() > until:
                    self.pgconn.finish()
                    raise driver.OperationalError("the server does not answer")
                wanted = gen.send(ready)
        except StopIteration as end:
            return end.value

    return type("Impatient", (driver.Connection,), {"wait": waits})


def postgres_error(error: Any, address: PostgresAddress) -> InputError | None:
    state, text = error.sqlstate or "", str(error).lower()
    if state in _LOCKED:
        return StudyBusyError(
            f"Another program has locked the study {address}; try again when it has finished."
        )
    if state == _LEFT:
        return StudyBusyError(
            f"The study {address} waited too long for this program, and nothing has changed; try "
            "again."
        )
    for sentences, found in ((_BY_STATE, state.startswith), (_BY_WORDS, text.__contains__)):
        for key, sentence in sentences.items():
            if found(key):
                return InputError(sentence.format(address))
    if state.startswith(_OURS):
        return None
    is_about_the_link = "OperationalError" in {each.__name__ for each in type(error).__mro__}
    if not is_about_the_link:
        return InputError(_BY_STATE["22"]) if "nul (0x00)" in text else None
    return StudyUnreachableError(
        f"The study {address} cannot be reached now. ({' '.join(text.split())[:_MAX_WORDS]})"
    )
