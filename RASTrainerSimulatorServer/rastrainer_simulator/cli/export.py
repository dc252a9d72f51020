"""`rastrainer export STUDY -o DIR`: a study for other programs."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from urllib.parse import urlsplit

from rastrainer.decision.drill_rows import drill_rows
from rastrainer.errors import InputError
from rastrainer.files.writing import make_empty_folder, write_text
from rastrainer.journal.recording import read_trajectory
from rastrainer.number_text import counted
from rastrainer.protocol import DECIDE
from rastrainer.study import tidy_csv
from rastrainer.study.database.database import StudyPlace
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.study_data import StudyData
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.cli.printing import json_text, read_known_study
from rastrainer_simulator.export.grades import grade, grades_csv
from rastrainer_simulator.export.trial_files import write_motion_bids, write_slicer_files
from rastrainer_simulator.export.xapi import statements
from rastrainer_simulator.report.published_tables import with_ctps

FORMATS = ("csv", "bids", "xapi", "slicer")


def export_study(arguments: argparse.Namespace) -> int:
    arguments.home_page = _home_page(arguments.home_page)
    if arguments.grades:
        return _export_grades(arguments)
    formats = arguments.format or [f for f in FORMATS if f != "bids" or arguments.records]
    if "bids" in formats and arguments.records is None:
        raise InputError("Motion-BIDS needs the journals: give their folder with --records.")
    data = with_ctps(read_known_study(arguments))
    make_empty_folder(arguments.output)
    for name in formats:
        print(f"{arguments.output / name}: {_write(name, data, arguments)}")
    if data.without_consent:
        print(f"Left out because they did not consent to research: {data.without_consent} trainees")
    return 0


def _export_grades(arguments: argparse.Namespace) -> int:
    with Study.open_for_reading(arguments.study) as opened:

        def attempts(pseudonym: str) -> Iterable[TrialRow]:
            if arguments.task == DECIDE:
                return drill_rows(opened.drills(pseudonym))
            return opened.attempts(pseudonym)

        method = "" if arguments.task == DECIDE else arguments.method
        found = {
            trainee.pseudonym: grade(
                attempts(trainee.pseudonym), arguments.task, arguments.mode, method, arguments.rule
            )
            for trainee in opened.trainees()
        }
    grades = {name: score for name, score in found.items() if score is not None}
    make_empty_folder(arguments.output)
    written = arguments.output / f"{arguments.grades}.csv"
    write_text(written, grades_csv(grades, arguments.grades))
    print(f"{written}: grades of {len(grades)} of {counted(len(found), 'trainee')}")
    return 0


def _write(name: str, data: StudyData, arguments: argparse.Namespace) -> str:
    folder = arguments.output / name
    if name == "bids":
        count = write_motion_bids(
            data, folder, lambda trial_id: read_trajectory(arguments.records, trial_id)
        )
        return f"{count} of {len(data.trials)} trials, {counted(len(data.drills), 'drill')}"
    make_empty_folder(folder)
    if name == "csv":
        tables = {
            "trials": tidy_csv.trials_csv(data.trials),
            "touches": tidy_csv.touches_csv(_stored(data, arguments.study)),
            "procedures": tidy_csv.procedures_csv(data.trials),
            "drills": tidy_csv.trials_csv(drill_rows(data.drills)),
            "cases": tidy_csv.cases_csv(data.drills),
            "aborted": tidy_csv.aborted_csv(data.aborted),
            "aborted_touches": tidy_csv.aborted_touches_csv(data.aborted),
            "scores": tidy_csv.scores_csv(data),
            "answers": tidy_csv.answers_csv(data),
            "ratings": tidy_csv.ratings_csv(data),
        }
        for table, text in tables.items():
            write_text(folder / f"{table}.csv", text)
    elif name == "xapi":
        found = statements(data, arguments.home_page)
        write_text(folder / "statements.json", json_text(found) + "\n")
    else:
        for trial, stored in _stored(data, arguments.study):
            write_slicer_files(stored, folder / trial.trial_id)
        return f"{len(data.trials)} trials"
    drills = counted(len(data.drills), "drill")
    return f"{len(data.trials)} trials, {len(data.aborted)} aborted ones, {drills}"


def _home_page(value: str) -> str:
    """Accept the address of a lab's own system, from which IRIs are made."""
    parts = urlsplit(value)
    # Every statement would show the password before an "@".
    is_safe = not any(sign in value for sign in "@?# ") and parts.hostname
    if parts.scheme not in ("https", "http") or not is_safe:
        raise InputError("--home-page: give an address such as https://lab.example.org.")
    return value.rstrip("/")


def _stored(data: StudyData, place: StudyPlace) -> Iterator[tuple[TrialRow, StoredTrial]]:
    """Yield the stored trials of a database; a CSV file has none."""
    known = [trial for trial in data.trials if trial.trial_id]
    if not known:
        return
    with Study.open_for_reading(place) as opened:
        for trial in known:
            yield trial, opened.trial(trial.trial_id)
