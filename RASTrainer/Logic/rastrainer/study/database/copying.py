"""Copy a whole study into an empty one, from SQLite to PostgreSQL or back."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest

from rastrainer.errors import InputError
from rastrainer.study.database.connection import Connection
from rastrainer.study.database.study import Study
from rastrainer.study.database.tables import Table, study_tables

COUNTER = "trainee_numbers"
"""The one table that a new study has a row in."""


def copy_study(source: Study, target: Study) -> dict[str, int]:
    """Copy all rows in one transaction, compare them, and return their number by table.

    The numbers of rows stay, and with them the order of storing; every float keeps each bit.

    Raises:
        InputError: the target holds something, or has other values afterwards; it stays empty.
        StudyAwayError: a server cannot be reached.
    """
    counts = {}
    with source.database.reading() as given, target.database.writing() as taken:
        for table in study_tables():
            if table.name != COUNTER and _count(taken, table):
                raise InputError("The study to copy to holds something; choose an empty one.")
        taken.execute(f"DELETE FROM {COUNTER}")
        for table in study_tables():
            marks = ", ".join("?" * len(table.columns))
            taken.executemany(
                f"INSERT INTO {table.name} ({', '.join(table.columns)}) VALUES ({marks})",
                _rows(given, table),
            )
        target.database.continue_numbers()
        for table in study_tables():
            pairs = zip_longest(_rows(given, table), _rows(taken, table))
            if any(tuple(before or ()) != tuple(after or ()) for before, after in pairs):
                raise InputError(f"The table {table.name} was not copied as it is; nothing is.")
            counts[table.name] = _count(taken, table)
    return counts


def _rows(connection: Connection, table: Table) -> Iterator[tuple]:
    return iter(
        connection.execute(
            f"SELECT {', '.join(table.columns)} FROM {table.name} ORDER BY {table.order}"
        )
    )


def _count(connection: Connection, table: Table) -> int:
    return connection.execute(f"SELECT count(*) FROM {table.name}").fetchone()[0]
