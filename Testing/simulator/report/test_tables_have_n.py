"""Every table of a report that has numbers of trials says of how many."""

import html
import re
from dataclasses import replace

import pytest

from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.report.report import report_html
from Testing.simulator.report.studied_procedures import with_procedures
from Testing.simulator.report.test_aborted_in_report import path  # noqa: F401
from Testing.simulator.report.test_decisions_in_report import studied
from Testing.simulator.report.test_methods_in_report import played
from Testing.simulator.report.test_raters_in_report import rated
from Testing.simulator.report.test_report import PUBLISHED, cohort
from Testing.simulator.report.without_charts import without_charts
from Testing.simulator.statistics.test_variation import drawn

pytestmark = pytest.mark.usefixtures("undrawn")

WORDS = {
    ("Metric", "Definition", "Source"),
    ("The paper says", "The trials say"),
    ("what", "version"),
    ("what", "target point error (mm)", "source"),
}
"""Tables without numbers of trials."""


def with_intervals(data):
    """Return a study whose expected target errors have intervals."""
    trials = [
        replace(trial, values={**trial.values, "tre_low_mm": 0.1, "tre_high_mm": 0.9})
        for trial in data.trials
    ]
    return replace(data, trials=tuple(trials))


def in_two_groups(data):
    """Return a study in which every second trainee is far slower and less accurate."""
    trials = []
    for trial in data.trials:
        if int(trial.trainee[1:]) % 2:
            values = trial.values
            values = {
                **values,
                "completion_time_s": values["completion_time_s"] + 200,
                "rmse_mm": values["rmse_mm"] + 6,
                "sparc": values["sparc"] - 8,
            }
            trial = replace(trial, values=values)
        trials.append(trial)
    return replace(data, trials=tuple(trials))


@pytest.fixture(scope="module")
def drawn_pages():
    """The reports that need no database."""
    studies = (
        read_study_data(PUBLISHED),
        with_intervals(drawn()),
        in_two_groups(cohort(12, tasks=2)),
        with_procedures(cohort(4)),
        played(4),
        rated(),
        studied(),
    )
    with without_charts():
        return [report_html(data, "today") for data in studies]


@pytest.fixture
def tables(drawn_pages, path):  # noqa: F811
    """Header cells, rows and preceding heading of every table of several reports."""
    pages = [*drawn_pages, report_html(read_study_data(path), "today")]
    return [found for page in pages for found in tables_of(page)]


def tables_of(page):
    for place in re.finditer(r"<table.*?</table>", page, re.DOTALL):
        headings = re.findall(r"<h[23]>(.*?)</h[23]>", page[: place.start()])
        head, body = re.search(
            r"<thead>(.*)</thead><tbody>(.*)</tbody>", place[0], re.DOTALL
        ).groups()
        lines = [cells(line) for line in re.findall(r"<tr>(.*?)</tr>", head)]
        yield headings[-1], lines[-1], [cells(row) for row in re.findall(r"<tr>(.*?)</tr>", body)]


def cells(line):
    line = line.replace("\N{NO-BREAK SPACE}", " ")
    return [html.unescape(text) for text in re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", line)]


def is_count(title):
    return title in ("n", "trials", "started (n)") or title.startswith("n, ")


def test_every_table_has_a_column_of_n_or_states_it_in_its_heading(tables):
    for heading, header, rows in tables:
        columns = [index for index, title in enumerate(header) if is_count(title)]
        if tuple(header) in WORDS:
            continue
        if not columns:
            # The paper's tables: a column for each subject and one trial in every cell.
            assert (header[0], header[-1]) == ("Task", "Task Perf.")
            assert re.fullmatch(r"Table .*: \d+ trainees?, \d+ trials?", heading)
        for row in rows:
            # A total may span several columns.
            if columns and len(row) == len(header):
                assert any(re.search(r"\d", row[column]) for column in columns), row
