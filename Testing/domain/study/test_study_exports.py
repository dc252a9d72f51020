"""Exports of answers, scores and versions as tables, as xAPI and in the report."""

import json
import uuid
from dataclasses import replace

import pytest

from rastrainer.study.protocol.questionnaires import SSQ
from rastrainer.study.study_data import read_study_data
from rastrainer.study.tidy_csv import answers_csv, scores_csv, trials_csv
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.export.xapi import HOME_PAGE, statements
from Testing.domain.study.played_study import study_with_trials
from Testing.domain.study.study_content import table_of


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    path = tmp_path_factory.mktemp("exported") / "study.db"
    study_with_trials(path)
    return read_study_data(path)


def test_every_answer_and_every_score_is_a_row(data):
    items, scores = table_of(answers_csv(data)), table_of(scores_csv(data))
    before = [row for row in items if row["step"] == "hmd/before/ssq"]
    assert [row["item"] for row in before] == [item.name for item in SSQ.items]
    assert {(row["trainee"], row["mode"], row["answer"]) for row in before} == {("A", "hmd", "1")}
    assert len(items) == sum(len(answered.answers) for answered in data.answers)
    exported = {
        row["scale"]: float(row["score"]) for row in scores if row["step"] == "hmd/before/ssq"
    }
    assert exported == SSQ.score([1] * 16)


def test_every_answered_questionnaire_is_a_statement_with_its_scores(data):
    answered = [s for s in statements(data) if s["verb"]["display"]["en-US"] == "answered"]
    assert len(answered) == len(data.answers) > 3
    assert len({uuid.UUID(statement["id"]) for statement in answered}) == len(answered)
    assert statements(data) == statements(data)
    step = f"{HOME_PAGE}/xapi/step"
    (before,) = (s for s in answered if s["context"]["extensions"][step] == "hmd/before/ssq")
    assert before["object"]["id"].endswith("/questionnaires/ssq")
    assert before["actor"]["account"]["name"] == "A"
    assert before["result"]["extensions"] == {
        f"{HOME_PAGE}/xapi/values/{scale}": score for scale, score in SSQ.score([1] * 16).items()
    }


def test_a_score_is_exported_with_its_parts(data):
    with_score = [trial for trial in data.trials if trial.score_version]
    rows = [row for row in table_of(trials_csv(data.trials)) if row["score_version"]]
    assert len(rows) == len(with_score) > 0
    for trial, row in zip(with_score, rows, strict=True):
        assert float(row["score_tre_mm"]) == trial.values["score_tre_mm"]
        assert float(row["score_common_bias_mm"]) == trial.values["score_common_bias_mm"]
        assert row["score_is_accurate"] in ("0.0", "1.0")
        assert 0 <= float(row["score_time_desirability"]) <= 1
    extensions = statements(data)[data.trials.index(with_score[0])]["result"]["extensions"]
    key = f"{HOME_PAGE}/xapi/values/score_tre_mm"
    assert extensions[key] == with_score[0].values["score_tre_mm"]


def test_a_trials_statement_has_success_and_completion_time(data):
    first, second, third = (
        replace(
            data.trials[0],
            trial_id=str(uuid.UUID(int=number)),
            values={**data.trials[0].values, "score": score, "completion_time_s": 110.0},
            acceptable=acceptable,
            started_utc="2026-01-01T10:00:00Z",
            completed_utc="2026-01-01T10:01:50Z",
        )
        for number, (score, acceptable) in enumerate(((80.0, True), (80.0, False), (79.9, True)))
    )
    unscored = replace(third, values={"completion_time_s": 110.0})
    protocol = replace(data.protocol, pass_mark=80.0)
    exported = statements(
        replace(data, trials=(first, second, third, unscored), protocol=protocol, answers=())
    )
    assert [s["result"].get("success") for s in exported] == [True, False, False, None]
    assert {s["version"] for s in exported} == {"1.0.0"}
    assert {s["timestamp"] for s in exported} == {"2026-01-01T10:01:50Z"}
    assert {s["result"]["duration"] for s in exported} == {"PT110.00S"}
    context = exported[0]["context"]["extensions"]
    assert context[f"{HOME_PAGE}/xapi/started"] == "2026-01-01T10:00:00Z"
    assert context[f"{HOME_PAGE}/xapi/pass-mark"] == 80.0


def test_a_statement_has_no_success_without_a_pass_mark_for_its_method(data):
    marked = replace(data.protocol, pass_mark=80.0)
    others = tuple(replace(trial, method="surface") for trial in data.trials)
    trials = (data.trials[0], *others)
    exported = statements(replace(data, trials=trials, protocol=marked, answers=(), aborted=()))
    assert ["success" in one["result"] for one in exported] == [True] + [False] * len(data.trials)
    assert all("score" in one["result"] for one in exported[1:])
    for one in exported[1:]:
        assert f"{HOME_PAGE}/xapi/pass-mark" not in one["context"]["extensions"]


def test_trainees_without_consent_are_left_out_of_exports_and_counted(tmp_path, capsys):
    study_with_trials(tmp_path / "study.db", consent=False)
    words = ["export", tmp_path / "study.db", "-o", tmp_path / "out"]
    assert main([str(word) for word in words]) == 0
    assert "did not consent to research: 1 trainees" in capsys.readouterr().out
    for name in ("trials", "touches", "scores", "answers"):
        rows = table_of((tmp_path / "out" / "csv" / f"{name}.csv").read_text())
        assert {row["trainee"] for row in rows} <= {"B"}
    content = json.loads((tmp_path / "out" / "xapi" / "statements.json").read_text())
    assert {statement["actor"]["account"]["name"] for statement in content} == {"B"}
