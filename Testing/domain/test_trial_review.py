"""A trial is reviewed as its study's protocol says, with its place among the trainee's own."""

import uuid
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rastrainer.experiment.study_progress import StudyProgress
from rastrainer.experiment.study_protocol import read_study_protocol
from rastrainer.protocol import TRIAL_RUN
from rastrainer.revealed_truth import RevealedTruth
from rastrainer.scenario import load_scenario
from rastrainer.scoring import SAFETY_METRICS
from rastrainer.study import Study
from rastrainer.trial_record import TrialRecord
from rastrainer.trial_review import review, with_progress
from Testing.domain.played_study import STUDIES
from Testing.domain.trial_records import make_record

SCENARIO = load_scenario(Path(__file__).parents[2] / "assets" / "scenarios" / "colin27")


@pytest.fixture
def study(tmp_path):
    with Study.open(tmp_path / "study.db") as study:
        study.create_trainee("T-001")
        yield study


def reviewed(study, number, task="task-1"):
    """A trial in which every fiducial was touched exactly, stored with its results."""
    record = make_record(
        trialId=str(uuid.UUID(int=number)),
        task=task,
        startedUtc=f"2024-05-17T09:{number:02d}:00Z",
        completedUtc=f"2024-05-17T09:{number + 2:02d}:00Z",
    )
    points = zip(record["points"], SCENARIO.task(task).fiducials.tolist(), strict=True)
    record["points"] = [{**point, "positionMm": place} for point, place in points]
    record["motion"] = dict.fromkeys(SAFETY_METRICS, 0.0)
    truth = RevealedTruth(tuple(np.eye(4).ravel().tolist()), 0.0)
    analysis = review(TrialRecord.from_json(record), SCENARIO, study, truth=truth)
    study.add_trial(record, [analysis.rigid], score=analysis.score)
    return with_progress(analysis, study)


def test_a_trial_is_told_how_it_stands_and_a_trial_run_is_not(study):
    assert reviewed(study, 1, TRIAL_RUN).feedback.progress is None
    assert len(reviewed(study, 2).feedback.progress.scores) == 1
    assert reviewed(study, 3, TRIAL_RUN).feedback.progress is None
    assert len(reviewed(study, 4).feedback.progress.scores) == 2


def test_the_pass_mark_is_that_of_the_studys_protocol(study):
    assert reviewed(study, 1).feedback.progress.passes
    published = read_study_protocol(STUDIES / "published-protocol.json")
    StudyProgress(study).begin(replace(published, pass_mark=100.0))
    assert reviewed(study, 2).feedback.progress.pass_mark == 100.0
    assert not reviewed(study, 3).feedback.progress.passes
