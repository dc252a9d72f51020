"""The report of a study: one HTML page, and its numbers as CSV files."""

from __future__ import annotations

import itertools
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path

from markupsafe import Markup

import rastrainer
from rastrainer.files.writing import make_folder, write_text
from rastrainer.number_text import with_units
from rastrainer.protocol import DECIDE
from rastrainer.study.outcomes import MAIN_OUTCOMES, MOTION_OUTCOMES
from rastrainer.study.study_data import StudyData
from rastrainer.study.tidy_csv import cases_csv, trials_csv
from rastrainer.work_progress import Progress, no_progress
from rastrainer_simulator.report import target_errors
from rastrainer_simulator.report.comparisons import compare_modes, compared_method
from rastrainer_simulator.report.conclusions import answers, left_out_methods, limits, methods
from rastrainer_simulator.report.decisions import decisions, decisions_of
from rastrainer_simulator.report.mode_comparison import mode_comparison, motion, paired_statistics
from rastrainer_simulator.report.page import render
from rastrainer_simulator.report.passing import passing, passing_of, started_trials
from rastrainer_simulator.report.procedures import procedures
from rastrainer_simulator.report.published_tables import paper_notes, published_tables, with_ctps
from rastrainer_simulator.report.raters import raters
from rastrainer_simulator.report.trainees import curricula, groups, learning, questionnaires
from rastrainer_simulator.report.variation import variation

PAGE, NUMBERS, CASES = "report.html", "trials.csv", "cases.csv"


def write_report(data: StudyData, folder: Path, progress: Progress = no_progress) -> Path:
    page_text = report_html(data, progress=progress)
    make_folder(folder)
    write_text(folder / PAGE, page_text)
    write_text(folder / NUMBERS, trials_csv(data.trials))
    if data.drills:
        write_text(folder / CASES, cases_csv(data.drills))
    return folder / PAGE


def report_html(
    data: StudyData, made_utc: str | None = None, progress: Progress = no_progress
) -> str:
    """Return the page, in the order of its readers: answers, the paper's tables, and the rest."""
    decided = decisions_of(data)
    data = replace(data, aborted=tuple(each for each in data.aborted if each.task != DECIDE))
    left_out, everything = left_out_methods(data), data
    of_methods = target_errors.compare_methods(target_errors.as_conditions(data))
    data = with_ctps(with_one_method(data))
    pairs = list(itertools.combinations(sorted(data.modes), 2))
    main = [compare_modes(data, MAIN_OUTCOMES, *pair) for pair in pairs]
    described = compare_modes(data, MOTION_OUTCOMES, *pairs[0]) if pairs else ()
    comparisons = [comparison for of_pair in main for comparison in of_pair]
    passed = passing_of(data)
    steps = (
        ("Answers", lambda: answers(data, comparisons, of_methods, passed, left_out, decided)),
        ("The paper's tables", lambda: published_tables(data) + paper_notes(data)),
        ("Comparison of modes", lambda: Markup().join(map(paired_statistics, main))),
        ("Charts by task", lambda: mode_comparison(data)),
        ("Learning", lambda: learning(data)),
        ("Sources of variation", lambda: variation(data)),
        ("Passed trials", lambda: started_trials(data) + passing(data, passed) + curricula(data)),
        ("Decisions", lambda: decisions(decided)),
        ("Target errors", lambda: target_errors.calibration(data)),
        ("Methods of registration", lambda: target_errors.method_comparison(everything)),
        ("Shifted skin", lambda: target_errors.shifted_skin(everything)),
        ("Procedures", lambda: procedures(data)),
        ("Motion", lambda: motion(data, described)),
        ("Raters and questionnaires", lambda: raters(data) + questionnaires(data)),
        ("Groups of trainees", lambda: groups(data)),
        ("Limits and methods", lambda: limits(data, comparisons) + methods(data)),
    )
    sections = []
    for number, (step, section) in enumerate(steps):
        progress(step, number / len(steps))
        sections.append(section())
    page = render(
        "report",
        data=data,
        made=made_utc or datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        sections=sections,
        version=rastrainer.__version__,
    )
    return with_units(page)


def with_one_method(data: StudyData) -> StudyData:
    method = compared_method(data)
    return replace(
        data,
        trials=tuple(t for t in data.trials if t.method == method),
        aborted=tuple(record for record in data.aborted if record.method == method),
    )
