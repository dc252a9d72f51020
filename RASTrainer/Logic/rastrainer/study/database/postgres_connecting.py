"""Connections to PostgreSQL that keep what was committed and notice when the other side is gone."""

from __future__ import annotations

import threading
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NoAnswerError
from typing import Any

from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.postgres_driver import postgres_driver, refuse_infinite_numbers

CONNECT_TIMEOUT_S = 10
INTERACTIVE_CONNECT_TIMEOUT_S = 2
"""The least that libpq takes."""
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


def connected(address: PostgresAddress, timeout_s: int) -> Any:
    """Return a connection; psycopg's error if there is none in time."""
    connection = postgres_driver().connect(
        **address.connection_words,
        **_NETWORK,
        # A server that has vanished is waited for no longer than one that is sought.
        tcp_user_timeout=1000 * timeout_s,
        autocommit=True,
        # For servers behind a pool of connections.
        prepare_threshold=None,
        application_name="RASTrainer",
        client_encoding="UTF8",
        connect_timeout=timeout_s,
    )
    refuse_infinite_numbers(connection)
    connection.execute(_SESSION)
    return connection


def connected_within(patience_s: float, address: PostgresAddress, timeout_s: int) -> Any:
    """Return a connection, or raise `TimeoutError` soon: one that comes later is closed."""
    answer: Future[Any] = Future()

    def attempt() -> None:
        try:
            connection = connected(address, timeout_s)
        except BaseException as error:
            if answer.set_running_or_notify_cancel():
                answer.set_exception(error)
            return
        if answer.set_running_or_notify_cancel():
            answer.set_result(connection)
        else:
            connection.close()

    threading.Thread(target=attempt, name="study", daemon=True).start()
    try:
        return answer.result(patience_s)
    except NoAnswerError:
        if answer.cancel():
            raise TimeoutError from None
        return answer.result()
