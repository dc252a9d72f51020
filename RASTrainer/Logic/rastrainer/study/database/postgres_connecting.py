"""Connections to PostgreSQL that keep what was committed and notice when the other side is gone."""

from __future__ import annotations

import threading
import time
from collections.abc import Generator
from concurrent.futures import Future, wait
from types import ModuleType
from typing import Any

from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.postgres_driver import postgres_driver, refuse_infinite_numbers

CONNECT_TIMEOUT_S = 10
SILENCE_S = 10
"""After which a connection is given up if the other side no longer confirms what it gets."""
INTERACTIVE_SILENCE_S = 2
ANSWER_S = 75
"""After which one is given up that confirms everything and answers nothing, as a server that hangs.

Longer than `statement_timeout`.
"""
INTERACTIVE_PATIENCE_S = 0.5
"""Of a window; the attempt goes on without it."""
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
"""A committed change survives a power failure, and a seat that has vanished blocks nobody."""
_NETWORK = {"keepalives_idle": 10, "keepalives_interval": 5}
_Waiting = Generator[Any, int, Any]
_attempts: dict[str, Future[Any]] = {}
"""Connections that windows wait for, by address."""


def connected(
    address: PostgresAddress, silence_s: int = SILENCE_S, answer_s: float = ANSWER_S
) -> Any:
    """Return a connection; psycopg's error if there is none in time."""
    connection = _impatient(postgres_driver(), answer_s).connect(
        **address.connection_words,
        **_NETWORK,
        tcp_user_timeout=1000 * silence_s,
        autocommit=True,
        # For servers behind a pool of connections.
        prepare_threshold=None,
        application_name="RASTrainer",
        client_encoding="UTF8",
        connect_timeout=CONNECT_TIMEOUT_S,
    )
    refuse_infinite_numbers(connection)
    connection.execute(_SESSION)
    return connection


def connected_within(patience_s: float, address: PostgresAddress) -> Any:
    """Return a connection, or raise `TimeoutError` soon: the next call gets it where it came."""
    key = str(address)
    if key not in _attempts:
        _attempts[key] = _begun(address)
    attempt = _attempts[key]
    wait([attempt], patience_s)
    if not attempt.done():
        raise TimeoutError
    del _attempts[key]
    return attempt.result()


def _begun(address: PostgresAddress) -> Future[Any]:
    answer: Future[Any] = Future()

    def attempt() -> None:
        try:
            answer.set_result(connected(address, INTERACTIVE_SILENCE_S, INTERACTIVE_SILENCE_S))
        except BaseException as error:
            answer.set_exception(error)

    threading.Thread(target=attempt, name="study", daemon=True).start()
    return answer


def _impatient(driver: ModuleType, answer_s: float) -> Any:
    """Return psycopg's class of connections, which waits without end, with an end to it."""

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
