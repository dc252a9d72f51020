"""Commands that manage a study's data: `rastrainer copy-study` and `rastrainer delete-trainee`."""

from __future__ import annotations

import argparse

from rastrainer.errors import InputError
from rastrainer.number_text import counted
from rastrainer.study.database.database import StudyDatabase
from rastrainer.study.database.schema import TABLES, Table
from rastrainer.study.database.study import Study
from rastrainer.study.trainee_data import erase_trainee

COUNTER = "trainee_numbers"
"""The one table that a new study has a row in."""


def copy_study(arguments: argparse.Namespace) -> int:
    place, new_place = vars(arguments)["from"], arguments.to
    if str(place) == str(new_place):
        raise InputError("FROM and TO are the same study.")
    with Study.open_for_reading(place) as source, Study.open(new_place) as target:
        counts = copy_rows(source, target)
    print(
        f"{new_place}: {counted(counts['trainees'], 'trainee')}, "
        f"{counted(counts['trials'], 'trial')}, {counted(sum(counts.values()), 'row')} in all, "
        "each compared with its original"
    )
    return 0


def copy_rows(source: Study, target: Study) -> dict[str, int]:
    """Copy all rows in one transaction, compare them, and return their number by table.

    The numbers of rows stay, and with them the order of storing; every float keeps each bit.
    """
    counts = {}
    given, taken = source.database, target.database
    with given.reading(), taken.writing():
        for table in TABLES.values():
            if table.name != COUNTER and taken.row(f"SELECT 1 FROM {table.name}") is not None:
                raise InputError("The study to copy to holds something; choose an empty one.")
        taken.change(f"DELETE FROM {COUNTER}")
        for table in TABLES.values():
            marks = ", ".join("?" * len(table.columns))
            rows = _rows(given, table)
            for row in rows:
                taken.change(
                    f"INSERT INTO {table.name} ({', '.join(table.columns)}) VALUES ({marks})", *row
                )
            if _rows(taken, table) != rows:
                raise InputError(f"The table {table.name} was not copied as it is; nothing is.")
            counts[table.name] = len(rows)
        taken.continue_numbers()
    return counts


def _rows(database: StudyDatabase, table: Table) -> list[tuple]:
    columns = ", ".join(table.columns)
    return database.rows(f"SELECT {columns} FROM {table.name} ORDER BY {table.order}")


def delete_trainee(arguments: argparse.Namespace) -> int:
    with Study.open(arguments.study, must_exist=True) as opened:
        trials = counted(len(opened.history(arguments.pseudonym)), "trial")
        drills = counted(len(opened.drills(arguments.pseudonym)), "drill")
        if not arguments.yes:
            raise InputError(
                f"{arguments.pseudonym} has {trials} and {drills}, which would be lost for good; "
                "add --yes to delete them."
            )
        if arguments.records is None:
            raise InputError(
                f"The journals of {arguments.pseudonym} would be left; name the folder of the "
                "simulator's journals with --records (an empty one if there are none)."
            )
        erased = erase_trainee(opened, arguments.pseudonym, arguments.records)
    print(f"{arguments.pseudonym}: {erased.trials} trials and {erased.journals} journals deleted")
    for sentence in erased.warnings:
        print(sentence)
    return 1 if erased.warnings else 0
