"""A trial is reviewed with its study's protocol and the trainee's history."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer.json_records import record_from_json
from rastrainer.protocol import TRIAL_RUN
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.delivered_trial import (
    score_references,
    scored_with_journal,
    store_delivered,
    with_progress,
)
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from Testing.domain.study.played_study import STUDIES
from Testing.domain.trial.trial_records import make_record

SCENARIO = load_scenario(Path(__file__).parents[3] / "assets" / "scenarios" / "colin27")


TRUTH = RevealedTruth(tuple(np.eye(4).ravel().tolist()), 0.0)


def exact_touches(number, task="task-1"):
    """The JSON record of a trial with exact touches."""
    record = make_record(
        number,
        task=task,
        startedUtc=f"2024-05-17T09:{number:02d}:00Z",
        completedUtc=f"2024-05-17T09:{number + 2:02d}:00Z",
    )
    points = zip(record["points"], SCENARIO.task(task).fiducials.tolist(), strict=True)
    record["points"] = [{**point, "positionMm": place} for point, place in points]
    record["motion"] = dict.fromkeys(SAFETY_METRICS, 0.0)
    return record


def reviewed(study, number, task="task-1"):
    """A trial with exact touches, stored with its results."""
    record = exact_touches(number, task)
    registered = analyze_trial(record_from_json(TrialRecord, record), SCENARIO)
    analysis = scored_with_journal(registered, TRUTH, SCENARIO, score_references(study))
    study.add_trial(record, [analysis.rigid], score=analysis.score)
    return with_progress(analysis, study)


def test_trials_get_progress_feedback_and_trial_runs_do_not(study):
    assert reviewed(study, 1, TRIAL_RUN).feedback.progress is None
    assert reviewed(study, 2).feedback.progress.sentences[0].key == "first trial"
    assert reviewed(study, 3, TRIAL_RUN).feedback.progress is None
    assert reviewed(study, 4).feedback.progress.sentences[0].key.endswith("points than last")


def test_the_pass_mark_is_that_of_the_studys_protocol(study):
    assert reviewed(study, 1).feedback.progress.sentences[1].startswith("Passed")
    published = StudyProtocol.read(STUDIES / "published-protocol.json")
    StudyProgress(study).set_protocol(replace(published, pass_mark=100.0))
    assert reviewed(study, 2).feedback.progress.pass_mark == 100.0
    assert not reviewed(study, 3).feedback.progress.sentences[1].startswith("Passed")


def test_a_delivered_trial_is_stored_with_its_unknown_keys(study):
    delivered = exact_touches(1) | {"ofALaterVersion": 1}
    taken, _ = store_delivered(delivered, study, lambda record: analyze_trial(record, SCENARIO))
    ((text,),) = study.database.rows("SELECT record_json FROM trials")
    assert json.loads(text) == delivered
    assert study.trial(taken.trial_id).record == taken
