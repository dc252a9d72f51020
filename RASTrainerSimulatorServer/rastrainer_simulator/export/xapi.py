"""Trials, drills and questionnaires as xAPI statements (IEEE 9274.1.1, xAPI 1.0.3)."""

from __future__ import annotations

import uuid
from typing import Any

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_rows import COLUMNS, cells, drill_rows
from rastrainer.study.outcomes import mode_title, task_title
from rastrainer.study.protocol.study_progress import QuestionnaireAnswers
from rastrainer.study.protocol.study_protocol import pass_mark_of
from rastrainer.study.study_data import StudyData
from rastrainer.trial.record import AbortedTrial
from rastrainer.trial.scoring import passes
from rastrainer.trial.trial_row import TrialRow

VERSION = "1.0.0"
"""That of the data model, which every xAPI 1.0.x shares; a provider must not name a later patch."""
HOME_PAGE = "https://rastrainer.invalid"
VERBS = {
    "completed": "http://adlnet.gov/expapi/verbs/completed",
    "terminated": "http://adlnet.gov/expapi/verbs/terminated",
    "answered": "http://adlnet.gov/expapi/verbs/answered",
}
SIMULATION = "http://adlnet.gov/expapi/activities/simulation"
SURVEY = "http://adlnet.gov/expapi/activities/assessment"
NAMESPACE = uuid.UUID("6f0f2f3e-6f53-5d8f-9a1a-7f7a52415354")
"""For the statements about questionnaires, whose UUIDs follow from their content."""


def statements(data: StudyData, home_page: str = HOME_PAGE) -> list[dict[str, Any]]:
    """Return a statement for each finished or aborted trial, drill and answered questionnaire.

    They have the trials' UUIDs, so duplicates are recognized; `home_page` is of the lab's system
    and makes pseudonyms unique.
    """
    trials = [
        _trial(trial, pass_mark_of(data.protocol, trial.method), home_page)
        for trial in data.trials
        if trial.trial_id
    ]
    trials += [_aborted(record, home_page) for record in data.aborted]
    rows = drill_rows(data.drills)
    trials += [_drill(*each, home_page) for each in zip(data.drills, rows, strict=True)]
    return trials + [_answers(answered, home_page) for answered in data.answers]


def _trial(trial: TrialRow, mark: float | None, home_page: str) -> dict[str, Any]:
    """Return the statement of a completed trial; its duration excludes pauses.

    Without a pass mark for its score there is no `success`.
    """
    result: dict[str, Any] = {
        "completion": True,
        "duration": f"PT{trial.values['completion_time_s']:.2f}S",
        "extensions": {
            f"{home_page}/xapi/values/{name}": value for name, value in sorted(trial.values.items())
        },
    }
    context = {
        f"{home_page}/xapi/mode": trial.mode,
        f"{home_page}/xapi/trial-number": trial.number,
        f"{home_page}/xapi/started": trial.started_utc,
    }
    if trial.score_version:
        context[f"{home_page}/xapi/score-version"] = trial.score_version
    if "score" in trial.values:
        score = trial.values["score"]
        result["score"] = {"scaled": round(score / 100, 6), "raw": score, "min": 0, "max": 100}
        if mark is not None:
            result["success"] = passes(score, trial.acceptable, mark)
            context[f"{home_page}/xapi/pass-mark"] = mark
    return _trial_statement("completed", trial, trial.completed_utc, result, context, home_page)


def _drill(drill: DrillRecord, row: TrialRow, home_page: str) -> dict[str, Any]:
    statement = _trial(row, None, home_page)
    cases = [dict(zip(COLUMNS, cells(case), strict=True)) for case in drill.cases]
    statement["result"]["extensions"][f"{home_page}/xapi/cases"] = cases
    statement["result"]["success"] = row.acceptable
    return statement


def _aborted(record: AbortedTrial, home_page: str) -> dict[str, Any]:
    result: dict[str, Any] = {
        "completion": False,
        "duration": f"PT{record.elapsed_s:.2f}S",
        "extensions": {
            f"{home_page}/xapi/values/touches": len(record.points),
            f"{home_page}/xapi/values/refused_touches": record.rejected_touches,
            f"{home_page}/xapi/values/undone_touches": record.undone_touches,
        },
    }
    if record.counts_as_failed:
        result["success"] = False
    context = {
        f"{home_page}/xapi/mode": record.mode,
        f"{home_page}/xapi/started": record.started_utc,
        f"{home_page}/xapi/aborted-in": record.phase,
        f"{home_page}/xapi/aborted-because": record.reason,
    }
    return _trial_statement("terminated", record, record.aborted_utc, result, context, home_page)


def _trial_statement(
    verb: str,
    trial: TrialRow | AbortedTrial,
    timestamp: str,
    result: dict[str, Any],
    context: dict[str, Any],
    home_page: str,
) -> dict[str, Any]:
    place = f"RASTrainer, {mode_title(trial.mode)}"
    return _statement(
        *(home_page, trial.trial_id, trial.trainee, verb, timestamp),
        object=_activity(f"{home_page}/tasks/{trial.task}", task_title(trial.task), SIMULATION),
        result=result,
        context={"platform": place, "extensions": context},
    )


def _answers(answered: QuestionnaireAnswers, home_page: str) -> dict[str, Any]:
    step, trainee, utc = answered.step, answered.trainee, answered.stored_utc
    identity = str(uuid.uuid5(NAMESPACE, f"{home_page} {trainee} {step.name} {utc}"))
    name = step.questionnaire
    scores = {f"{home_page}/xapi/values/{each}": score for each, score in answered.scores.items()}
    return _statement(
        *(home_page, identity, trainee, "answered", utc),
        object=_activity(f"{home_page}/questionnaires/{name}", name, SURVEY),
        result={"completion": True, "extensions": scores},
        context={"extensions": {f"{home_page}/xapi/step": step.name}},
    )


def _statement(
    home_page: str, identity: str, trainee: str, verb: str, timestamp: str, **content: Any
) -> dict[str, Any]:
    return {
        "id": identity,
        "version": VERSION,
        "actor": {"objectType": "Agent", "account": {"homePage": home_page, "name": trainee}},
        "verb": {"id": VERBS[verb], "display": {"en-US": verb}},
        **content,
        "timestamp": timestamp,
    }


def _activity(iri: str, name: str, kind: str) -> dict[str, Any]:
    definition = {"type": kind, "name": {"en-US": name}}
    return {"objectType": "Activity", "id": iri, "definition": definition}
