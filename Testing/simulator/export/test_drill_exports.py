"""Drills of decisions are exported as tables, as BIDS and as xAPI statements, with units."""

import json
import re
import subprocess
import uuid
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.decision.drill_rows import COLUMNS
from rastrainer.decision.drill_score import drill_score
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import StudyData
from rastrainer.study.tidy_csv import cases_csv
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


def test_the_bids_validator_finds_no_error_in_a_dataset_of_drills(dataset):
    ended = subprocess.run(
        [VALIDATOR, "--format", "json", dataset], capture_output=True, check=False
    )
    issues = json.loads(ended.stdout)["issues"]["issues"]
    assert [issue for issue in issues if issue["severity"] == "error"] == []
    assert ended.returncode == 0


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
