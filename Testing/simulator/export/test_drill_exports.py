"""Drills of decisions are exported as tables, as BIDS and as xAPI statements, with units."""

import csv
import io
import json
import re
import subprocess
import uuid
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.decision.drill_record import DecidedCase, Decision, Fault
from rastrainer.decision.drill_rows import COLUMNS, drill_rows
from rastrainer.decision.drill_score import DRILL_SCORE_VERSION, drill_score
from rastrainer.protocol import RegistrationMethod
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import StudyData
from rastrainer.study.tidy_csv import cases_csv, trials_csv
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.export.trial_files import write_motion_bids
from rastrainer_simulator.export.xapi import HOME_PAGE, statements
from Testing.drawn_drills import draw_drills
from Testing.simulator.virtual.test_exports import VALIDATOR

HOSTILE = ("=HYPERLINK(1)", "a\tb\nc\r\x0b d", "任务 \u2028 ü", '";"')


@pytest.fixture(scope="module")
def data():
    """A study of three trainees with two drills each, and a case whose places are hostile."""
    drills = list(draw_drills(np.random.default_rng(4), 3, (1.0, 2.0)))
    cases = drills[0].cases
    drills[0] = replace(drills[0], cases=(replace(cases[0], checks=HOSTILE), *cases[1:]))
    return StudyData("Drills", (), drills=tuple(drills))


@pytest.fixture(scope="module")
def dataset(data, tmp_path_factory):
    folder = tmp_path_factory.mktemp("drills") / "bids"
    assert write_motion_bids(data, folder, lambda _id: None) == 0
    return folder


def read_back(row):
    """The case of a row of a table, whose checks are not read."""
    known = {name: row[name] for name in COLUMNS if name not in ("checks", "is_right")}
    numbers = {name: float(text) for name, text in known.items() if name.endswith("_mm")}
    case = DecidedCase(
        seed=int(row["seed"]),
        fault=Fault(row["fault"]),
        method=RegistrationMethod(row["method"]),
        **numbers,
        difficulty=float(row["difficulty"]),
        has_read_images=row["has_read_images"] == "1",
        decision=Decision(row["decision"]),
        confidence=int(row["confidence"]),
        suspected=Fault(row["suspected"]) if row["suspected"] not in ("", "n/a") else None,
        time_s=float(row["time_s"]),
    )
    assert int(row["is_right"]) == case.is_right
    return case


def all_cases(drills):
    return [replace(case, checks=()) for drill in drills for case in drill.cases]


def test_every_case_is_a_row_from_which_it_can_be_read_again(data):
    rows = list(csv.DictReader(io.StringIO(cases_csv(data.drills))))
    assert [read_back(row) for row in rows] == all_cases(data.drills)
    assert [int(row["case"]) for row in rows] == [*range(1, 21)] * 6
    assert [row["drill"] for row in rows[::20]] == ["1", "2"] * 3
    first = rows[0]
    assert first["trial_id"] == data.drills[0].trial_id
    # No text is a formula for a spreadsheet.
    assert first["checks"] == "'" + "; ".join(HOSTILE)


def test_a_study_of_drills_alone_is_exported_without_those_who_did_not_consent(data, tmp_path):
    with Study.open(tmp_path / "study.db") as study:
        for name in ("T000", "T001", "T002"):
            study.create_trainee(name, consent=name != "T001")
        for drill in data.drills[1:]:
            study.add_drill(drill)
    words = ["export", str(tmp_path / "study.db"), "-o", str(tmp_path / "out")]
    words += ["--records", str(tmp_path)]
    assert main(words) == 0
    left = tuple(drill for drill in data.drills[1:] if drill.trainee != "T001")
    assert (tmp_path / "out" / "csv" / "cases.csv").read_text() == cases_csv(left)
    found = json.loads((tmp_path / "out" / "xapi" / "statements.json").read_text())
    assert [statement["id"] for statement in found] == [drill.trial_id for drill in left]
    subjects = sorted(path.name for path in (tmp_path / "out" / "bids").glob("sub-*"))
    assert subjects == ["sub-T000", "sub-T002"]


def test_every_drill_is_a_row_with_its_score(data):
    rows = list(csv.DictReader(io.StringIO(trials_csv(drill_rows(data.drills)))))
    for row, drill in zip(rows, data.drills, strict=True):
        found = drill_score(drill.cases)
        assert (row["trainee"], row["task"]) == (drill.trainee, "decide")
        assert (row["score_version"], row["method"]) == (DRILL_SCORE_VERSION, "")
        assert float(row["sensitivity"]) == found.sensitivity.value
        assert float(row["score"]) == found.score
        assert float(row["harmful"]) == found.harmful


def test_the_bids_validator_finds_no_error_in_a_dataset_of_drills(dataset):
    ended = subprocess.run(
        [VALIDATOR, "--format", "json", dataset], capture_output=True, check=False
    )
    issues = json.loads(ended.stdout)["issues"]["issues"]
    assert [issue for issue in issues if issue["severity"] == "error"] == []
    assert ended.returncode == 0


def test_a_bids_table_has_the_cases_of_its_drill_and_its_description_their_units(data, dataset):
    description = json.loads((dataset / "task-decide_beh.json").read_text())
    for drill in data.drills:
        run = int(drill.started_utc[8:10])
        name = f"sub-{drill.trainee}_task-decide_acq-desktop_run-{run:02d}_beh.tsv"
        text = (dataset / f"sub-{drill.trainee}" / "beh" / name).read_text(encoding="utf-8")
        head, *lines = (line.split("\t") for line in text.split("\n")[:-1])
        rows = [dict(zip(head, line, strict=True)) for line in lines]
        assert [read_back(row) for row in rows] == all_cases([drill])
        assert "" not in [cell for line in lines for cell in line]
        for column in head:
            unit = re.search("_(mm|s)$", column)
            assert description[column]["Description"]
            assert not unit or description[column]["Units"] == unit[1]
    participants = (dataset / "participants.tsv").read_text().split("\n")
    assert [line.split("\t")[0] for line in participants[1:-1]] == [
        "sub-T000",
        "sub-T001",
        "sub-T002",
    ]


def test_every_drill_is_a_statement_with_score_success_and_cases(data):
    found = statements(data)
    assert found == statements(data)
    for statement, drill in zip(found, data.drills, strict=True):
        score, result = drill_score(drill.cases), statement["result"]
        assert uuid.UUID(statement["id"]) == uuid.UUID(drill.trial_id)
        assert statement["actor"]["account"]["name"] == drill.trainee
        assert statement["object"]["id"] == f"{HOME_PAGE}/tasks/decide"
        assert statement["timestamp"] == drill.completed_utc
        assert result["score"]["raw"] == score.score
        assert result["score"]["scaled"] == pytest.approx(score.score / 100, abs=1e-6)
        assert result["success"] is score.is_passed
        assert re.fullmatch(r"PT\d+\.\d\dS", result["duration"])
        cases = result["extensions"][f"{HOME_PAGE}/xapi/cases"]
        assert [set(case) for case in cases] == [set(COLUMNS)] * 20
        right = [case["is_right"] for case in json.loads(json.dumps(cases))]
        assert right == [case.is_right for case in drill.cases]
    assert {statement["result"]["success"] for statement in found} == {True, False}
