"""A study's file as an earlier RASTrainer left it."""

from __future__ import annotations

import itertools
import sqlite3
from pathlib import Path

from rastrainer.study.database.schema import APPLICATION_ID, MIGRATIONS


def write_old_study(path: Path, version: int, *statements: str) -> None:
    """Write a study in a former format, with the rows that statements insert."""
    connection = sqlite3.connect(path)
    for statement in itertools.chain(*MIGRATIONS[:version], statements):
        connection.execute(statement)
    connection.execute(f"PRAGMA user_version = {version}")
    connection.execute(f"PRAGMA application_id = {APPLICATION_ID}")
    connection.commit()
    connection.close()
