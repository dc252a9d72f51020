"""The tables of a study in PostgreSQL: whose they are, and the steps to the newest ones."""

from __future__ import annotations

from typing import Any

from rastrainer.errors import InputError
from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.connection import Connection
from rastrainer.study.database.schema import APPLICATION_ID, MIGRATIONS
from rastrainer.study.database.tables import in_postgres

LOCKED = "UPDATE rastrainer_study SET changes = changes + 1"
"""By which a writer waits for the one before it, and tells others of its change."""
_TABLES = """
    SELECT count(*) FROM pg_class WHERE relnamespace = 'public'::regnamespace AND relkind = 'r'
"""
_COMMANDS = """
    SELECT (SELECT count(*) FROM pg_class
            WHERE relnamespace = 'public'::regnamespace AND relkind NOT IN ('r', 'i', 'S'))
        + (SELECT count(*) FROM pg_trigger JOIN pg_class ON pg_class.oid = tgrelid
            WHERE relnamespace = 'public'::regnamespace AND NOT tgisinternal)
        + (SELECT count(*) FROM pg_rewrite JOIN pg_class ON pg_class.oid = ev_class
            WHERE relnamespace = 'public'::regnamespace)
        + (SELECT count(*) FROM pg_policy JOIN pg_class ON pg_class.oid = polrelid
            WHERE relnamespace = 'public'::regnamespace)
"""
_HEADER = """
    CREATE TABLE rastrainer_study (
        application_id BIGINT NOT NULL, user_version BIGINT NOT NULL, changes BIGINT NOT NULL
    )
"""


def check_server(connection: Any, address: PostgresAddress) -> None:
    """Raise `InputError` if the server keeps texts or promises other than ours."""
    if _first(connection, "SHOW server_encoding") != "UTF8":
        raise InputError(f"The database {address} must have the encoding UTF8.")
    if _first(connection, "SHOW fsync") != "on":
        raise InputError(
            f"The server of {address} runs with fsync = off and could lose trials that it has "
            "acknowledged; switch it on."
        )


def stored_version(connection: Any, address: PostgresAddress) -> int:
    """Return how many steps the schema has taken; 0 in an empty database.

    Raises:
        InputError: the database is another program's, of a newer RASTrainer, or runs commands of
            its own.
    """
    if _first(connection, _COMMANDS):
        raise InputError(
            f"The study {address} holds triggers, views, rules or policies; ours has none."
        )
    is_study = "SELECT count(*) FROM pg_tables WHERE tablename = 'rastrainer_study'"
    if not _first(connection, is_study):
        if _first(connection, _TABLES):
            raise InputError(f"{address} is the database of another program.")
        return 0
    rows = connection.execute(
        "SELECT application_id, user_version FROM rastrainer_study"
    ).fetchall()
    if len(rows) != 1 or rows[0][0] != APPLICATION_ID:
        raise InputError(f"{address} is the database of another program.")
    version = rows[0][1]
    if version > len(MIGRATIONS):
        raise InputError(
            f"The study {address} was made by a newer RASTrainer (format {version}, this one knows "
            f"{len(MIGRATIONS)}); update it."
        )
    return version


def migrate(connection: Connection, address: PostgresAddress) -> None:
    """Make the tables, or those that are missing, in the caller's transaction."""
    # Another process may be doing the same.
    connection.execute("SELECT pg_advisory_xact_lock(?)", (APPLICATION_ID,))
    version = stored_version(connection, address)
    if version == 0:
        connection.execute(_HEADER)
        connection.execute("INSERT INTO rastrainer_study VALUES (?, 0, 0)", (APPLICATION_ID,))
    connection.execute(LOCKED)
    for step in MIGRATIONS[version:]:
        for statement in step:
            connection.execute(in_postgres(statement))
    connection.execute("UPDATE rastrainer_study SET user_version = ?", (len(MIGRATIONS),))


def _first(connection: Any, query: str) -> Any:
    return connection.execute(query).fetchone()[0]
