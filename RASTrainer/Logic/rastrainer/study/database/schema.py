"""The tables of a study, from `schema.sql`."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError

APPLICATION_ID = 0x52415354
"""Written into the file's header (`RAST`); another program's database is recognized by it."""
SCHEMA_VERSION = 1
"""In `user_version` of a file."""
TRAINEE_ID = "SELECT id FROM trainees WHERE pseudonym = ?"


@dataclass(frozen=True)
class Table:
    """A table of the schema; ordered by `order`, its rows are always in the same order.

    Rows with an `id` are then in order of storing.
    """

    name: str
    columns: tuple[str, ...]
    order: str


def check_schema_version(version: int, place: object) -> None:
    if version != SCHEMA_VERSION:
        raise InputError(
            f"The study {place} has version {version} of the tables, and this RASTrainer reads "
            f"version {SCHEMA_VERSION}. Open it with the RASTrainer that made it; it was left as "
            "it is."
        )


def lacking_sentence(place: object) -> str:
    return (
        f"The database {place} holds no study with all tables that this RASTrainer uses. A study "
        "of an earlier one gets them once it is opened in 3D Slicer."
    )


def _table(statement: str) -> Table:
    columns = tuple(re.findall(r"[(,\n]\s*(\w+) (?:TEXT|INTEGER|DOUBLE)\b", statement))
    order = "id" if "id" in columns else ", ".join(columns[:2])
    return Table(statement.split()[2], columns, order)


_SQL = re.sub("--.*", "", Path(__file__).with_name("schema.sql").read_text(encoding="utf-8"))
STATEMENTS = tuple(text.strip() for text in _SQL.split(";") if text.strip())


def missing_from(names: Collection[str]) -> list[str]:
    """Return the statements of tables and indexes that are not among these names."""
    return [text for text in STATEMENTS if text.split()[2] not in names]


TABLES = {
    table.name: table for table in map(_table, filter(re.compile("CREATE TABLE").match, STATEMENTS))
}
"""Each after those that it refers to."""
