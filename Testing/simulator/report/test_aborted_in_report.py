"""Aborted trials in reports and exports; aborting bad trials does not show competence."""

import uuid
from dataclasses import replace

import pytest

from rastrainer.json_records import record_from_json
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.study_data import StudyData, read_study_data
from rastrainer.study.tidy_csv import aborted_csv, aborted_touches_csv
from rastrainer.trial.record import AbortedTrial
from rastrainer.trial.trial_feedback import competence_of
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.export.xapi import statements
from rastrainer_simulator.report.report import report_html
from Testing.domain.study.played_study import study_with_trials
from Testing.domain.study.study_content import table_of
from Testing.domain.trial.trial_records import make_aborted
from Testing.simulator.report.test_report import words_of

pytestmark = pytest.mark.usefixtures("undrawn")

REASON = "the head had slipped from its stand"


@pytest.fixture
def path(tmp_path):
    """A study in which B explained an aborted trial, and A aborted another one."""
    path = tmp_path / "study.db"
    study_with_trials(path)
    with Study.open(path) as study:
        progress = StudyProgress(study)
        while progress.progress("B").next_step.task != "task-1":
            progress.skip("B", progress.progress("B").next_step.name, "left out to be quick")
        mode = progress.progress("B").next_step.mode
        started = "2999-01-01T11:00:00Z"
        study.add_aborted(make_aborted(901, 15, trainee="B", mode=mode, startedUtc=started))
        progress.explain_repeat("B", REASON)
        study.add_aborted(make_aborted(902, 2, trainee="A", startedUtc="2999-01-01T09:00:00Z"))
        study.add_aborted(
            make_aborted(903, 1, trainee="A", task="trial-run", reason="practice over")
        )
        study.create_trainee("C")
        study.add_aborted(make_aborted(904, 5, trainee="C"))
    return path


def test_the_report_says_how_many_trials_were_started_and_why_steps_were_repeated(path):
    data = read_study_data(path)
    words = words_of(report_html(data))
    finished = len(data.trials)
    assert f"{finished} of {finished + 2} started trials were finished" in words
    assert f"all trials of the study {finished + 2} {finished} 1 1" in words
    assert "1 trial run was ended without being registered" in words
    assert "aborted with 15 points touched (trainee): " + REASON in words
    # C did not consent.
    assert {record.trainee for record in data.aborted} == {"A", "B"}
    assert "For 1 aborted trial no reason of a repeat is stored" in words


def row(number, score=90.0, **others):
    values = {"completion_time_s": 90.0, "rmse_mm": 1.0}
    values |= {} if score is None else {"score": score}
    known = {"started_utc": f"2024-05-17T{number + 8:02d}:00:00Z", "acceptable": True, **others}
    return TrialRow("A", "hmd", "task-1", number, values, **known)


def aborted(number, **changes):
    return record_from_json(AbortedTrial, make_aborted(number, trainee="A", mode="hmd", **changes))


def test_an_aborted_trial_counts_as_not_passed_in_the_lc_cusum():
    whole = StudyData("x", tuple(map(row, range(1, 13))), has_order=True)
    shown_at = competence_of([False] * 12).competent_at
    assert f"12 12 (100 %) 1 of 1 {shown_at} 0 0" in words_of(report_html(whole))
    early = aborted(900, startedUtc="2024-05-17T09:30:00Z")
    run = aborted(901, startedUtc="2024-05-17T10:30:00Z", task="trial-run")
    later = competence_of([False, True, *[False] * 11]).competent_at
    assert later > shown_at
    with_one = replace(whole, aborted=(early, run))
    assert f"13 12 (92 %) 1 of 1 {later} 1 0" in words_of(report_html(with_one))


def test_a_trial_without_a_score_counts_as_not_passed_and_is_named():
    unscored = row(2, score=None, acceptable=False, trial_id=str(uuid.UUID(int=2)))
    words = words_of(report_html(StudyData("x", (row(1), unscored, row(3)), has_order=True)))
    assert "3 2 (67 %) 0 of 1 – 0 1" in words
    assert "1 finished trial without a score: each counts as not passed" in words
    assert str(uuid.UUID(int=2)) in words


def test_the_report_names_the_trials_that_never_arrived(path):
    series = str(uuid.UUID(int=77))
    with Study.open(path) as study:
        for number in (3, 4, 7, 9):
            record = make_aborted(950 + number, 2, trainee="A") | {"number": number}
            study.add_aborted(record | {"series": series})
        # A deleted trainee leaves no gap.
        deleted = make_aborted(970, 2, trainee="D") | {"number": 8, "series": series}
        study.add_aborted(deleted)
        study.delete_trainee("D")
    words = words_of(report_html(read_study_data(path)))
    assert f"2 started trials of the simulator {series[:8]} never arrived in this study" in words
    assert "5 to 6" in words


def test_aborted_trials_and_their_touches_are_exported(path):
    data = read_study_data(path)
    rows = table_of(aborted_csv(data.aborted))
    assert [(row["trainee"], row["touches"], row["phase"], row["trial_run"]) for row in rows] == [
        ("A", "1", "running", "1"),
        ("A", "2", "running", "0"),
        ("B", "15", "complete", "0"),
    ]
    assert [row["repeat_reason"] for row in rows] == ["", "", REASON]
    assert [row["counts_as_not_passed"] for row in rows] == ["0", "1", "1"]
    assert len(table_of(aborted_touches_csv(data.aborted))) == 18
    found = [s for s in statements(data) if s["verb"]["display"]["en-US"] == "terminated"]
    assert [statement["id"] for statement in found] == [s.trial_id for s in data.aborted]
    assert [statement["result"].get("success") for statement in found] == [None, False, False]
