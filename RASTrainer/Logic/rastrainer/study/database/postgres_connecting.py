"""Connections to PostgreSQL that keep what was committed and notice when the other side is gone."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from typing import Any

from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.postgres_driver import postgres_driver, refuse_infinite_numbers

CONNECT_TIMEOUT_S = 10
SILENCE_S = 10
"""After which a connection is given up if the other side no longer confirms what it gets."""
INTERACTIVE_SILENCE_S = 2
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
_attempts: dict[str, Future[Any]] = {}
"""Connections that windows wait for, by address."""


def connected(address: PostgresAddress, silence_s: int = SILENCE_S) -> Any:
    """Return a connection; psycopg's error if there is none in time."""
    connection = postgres_driver().connect(
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
    try:
        connection = attempt.result(patience_s)
    except Exception:
        if not attempt.done():
            raise TimeoutError from None
        del _attempts[key]
        raise
    del _attempts[key]
    return connection


def _begun(address: PostgresAddress) -> Future[Any]:
    answer: Future[Any] = Future()

    def attempt() -> None:
        try:
            answer.set_result(connected(address, INTERACTIVE_SILENCE_S))
        except BaseException as error:
            answer.set_exception(error)

    threading.Thread(target=attempt, name="study", daemon=True).start()
    return answer
