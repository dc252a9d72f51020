"""Drills of decisions in a study: stored once, counted for steps and assignments, and erased."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import DECIDE, AssignmentState
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import progress_of_assignment, title_of
from rastrainer.study.database.database import PostgresAddress
from rastrainer.study.database.schema import TABLES
from rastrainer.study.database.study import DeletedTrialError, Study
from rastrainer.study.delivered_trial import store_delivered
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.study_data import read_study_data
from rastrainer.study.trainee_data import export_trainee
from rastrainer_simulator.cli.main import main
from Testing.domain.study.study_content import rows_of
from Testing.domain.study.test_experiment import enrolled, protocol
from Testing.domain.trial.trial_records import gentle_score, make_aborted, make_record
from Testing.drawn_drills import draw_drill


def drill(seed=1, trainee="T001", is_passed=True, hour=9, **changes):
    """A drill that was started after its trainee was enrolled, and is passed or not."""
    drawn = draw_drill(np.random.default_rng(seed), trainee, sensitivity=9.0 if is_passed else 0.0)
    utc = {"started_utc": f"2999-01-01T{hour:02d}:00:00Z"}
    return replace(drawn, **{**utc, "completed_utc": f"2999-01-01T{hour:02d}:30:00Z", **changes})


def delivered(record, **changes):
    return {**json.loads(json.dumps(record_to_json(record))), **changes}


def store(study, delivery):
    return store_delivered(delivery, study, analyze=None)


def test_a_delivered_drill_is_stored_once_as_it_came_and_another_of_its_uuid_refused(study):
    late, early = drill(1, hour=11), drill(2, hour=10)
    for each in (late, early, late):
        taken, analysis = store(study, delivered(each, task=DECIDE, ofALaterVersion=1))
        assert (taken, analysis) == (each, None)
    assert study.drills("T001") == (early, late)
    # An unknown trainee was added, so that no drill is lost.
    assert not study.trainee("T001").consent
    ((text,), *_) = study.database.rows("SELECT record_json FROM drills ORDER BY id")
    assert json.loads(text)["ofALaterVersion"] == 1
    with pytest.raises(InputError, match="Another trial is stored"):
        store(study, delivered(late, mode="hmd"))
    aborted = make_aborted(trialId=late.trial_id)
    with pytest.raises(InputError, match="Another trial is stored"):
        study.add_aborted(aborted)
    study.add_trial(make_record(trialId=drill(3).trial_id))
    with pytest.raises(InputError, match="Another trial is stored"):
        study.add_drill(drill(3))
    assert (study.history("T001"), study.attempts("T001")) == ((), ())
    with pytest.raises(InputError, match="no trainee"):
        study.drills("nobody")


def test_a_deleted_trainees_drill_leaves_no_row_and_is_not_stored_again(study):
    study.add_drill(drill(1, "gone"))
    study.add_drill(drill(2, "staying"))
    study.delete_trainee("gone")
    rows = str([study.database.rows(f"SELECT * FROM {name}") for name in TABLES])
    assert drill(1).trial_id not in rows
    assert drill(2).trial_id in rows
    with pytest.raises(DeletedTrialError):
        store(study, delivered(drill(1, "gone")))
    assert [trainee.pseudonym for trainee in study.trainees()] == ["staying"]


def test_a_trainees_export_has_the_drills_whole(study, tmp_path):
    for record in (drill(1), drill(2, "other")):
        study.add_drill(record)
    export_trainee(study, "T001", tmp_path / "T001.json")
    text = (tmp_path / "T001.json").read_text(encoding="utf-8")
    (exported,) = json.loads(text)["drills"]
    assert record_from_json(type(drill()), exported) == drill(1)
    assert drill(2).trial_id not in text


def test_drills_are_copied_with_their_study(study, study_place, tmp_path):
    study.add_drill(drill())
    assert main(["copy-study", str(study_place), str(tmp_path / "copy.db")]) == 0
    with Study.open_for_reading(tmp_path / "copy.db") as copy:
        assert copy.drills("T001") == (drill(),)
    assert rows_of(study_place) == rows_of(tmp_path / "copy.db")


def test_a_study_begun_without_drills_gets_their_table_and_keeps_its_trials(study_place):
    with Study.open(study_place) as study:
        study.add_trial(make_record())
        study.database.change("DROP TABLE drills")
    with pytest.raises(InputError, match=r"gets them once it is opened in 3D Slicer"):
        Study.open_for_reading(study_place)
    with Study.open(study_place, must_exist=True) as study:
        assert study.add_drill(drill(trainee="T-001"))
        assert len(study.history("T-001")) == 1
    Study.open_for_reading(study_place).close()
    if not isinstance(study_place, PostgresAddress):
        assert list(study_place.parent.iterdir()) == [study_place]


def test_a_step_is_done_by_a_stored_drill_of_its_mode_started_after_the_former_step(study):
    study.create_trainee()
    plan = {"tasks": ["task-1"], "modes": ["hmd", "desktop"], "trialRunMin": 0}
    progress = enrolled(
        study, drills=["before-all", "after-all"], questionnaires=[], breakBetweenModesMin=0, **plan
    )
    assert (
        progress.progress("T001").sentence
        == "Step 1 of 4: Do the drill of decisions with the headset."
    )
    with pytest.raises(InputError, match="a stored drill that counts for it"):
        progress.finish("T001", "before-all/decide")
    with pytest.raises(InputError, match="Not yet"):
        progress.progress("T001").check_start("desktop", DECIDE)
    assert progress.progress("T001").check_start("hmd", DECIDE).name == "before-all/decide"
    early = {"started_utc": "2024-01-01T09:00:00Z"}
    for uncounted in (drill(1, mode="desktop"), drill(2, mode="hmd", **early)):
        study.add_drill(uncounted)
        assert progress.count_played("T001").next_step.name == "before-all/decide"
    study.add_drill(drill(3, mode="hmd", hour=10))
    assert progress.played("T001").next_step.name == "hmd/1/task-1"
    assert progress.count_played("T001").counted_trials == (drill(3).trial_id,)
    for number, step in enumerate(progress.progress("T001").steps[1:3]):
        utc = f"2999-01-01T1{1 + number}:00:00Z"
        played = {"trainee": "T001", "task": step.task, "mode": step.mode, "startedUtc": utc}
        study.add_trial(make_record(number, **played), score=gentle_score(110.0, 0.5))
    # The drill before the training does not count after it, and neither does one during it.
    study.add_drill(drill(4, mode="hmd", hour=11))
    assert progress.count_played("T001").next_step.name == "after-all/decide"
    study.add_drill(drill(5, mode="hmd", hour=13))
    assert progress.count_played("T001").next_step is None


def test_a_report_has_the_drills_of_consenting_trainees_and_in_a_protocol_those_of_its_steps(
    study, study_place
):
    for name, consent in (("T001", True), ("T002", True), ("T003", False)):
        study.create_trainee(name, consent)
    progress = StudyProgress(study)
    progress.set_protocol(protocol(drills=["before-all"], questionnaires=[]))
    progress.enroll("T001")
    kept = drill(1, mode="hmd"), drill(2, "T002")
    for each in (*kept, drill(3, mode="hmd", hour=12), drill(4, "T003")):
        study.add_drill(each)
    data = read_study_data(study_place)
    assert data.drills == kept
    assert (data.outside_protocol, data.without_consent) == (1, 1)
    assert data.versions["simulator"] == ("0.1.0",)


DECIDES = {"name": "decides", "task": DECIDE, "trials": 2}


def curriculum(**changes):
    after = {"name": "touches", "task": "task-1", "after": ["decides"]}
    parts = {"assignments": [{**DECIDES, **changes}, after]}
    return Curriculum.from_json({"formatVersion": 1, "name": "c", "title": "C", **parts})


def test_an_assignment_is_reached_by_drills_passed_in_a_row_whatever_their_score(study):
    study.create_trainee()
    store_ = CurriculumStore(study)
    store_.choose(curriculum())
    seen = store_.stamps()
    for hour, is_passed in enumerate((True, False, True), start=8):
        study.add_drill(drill(hour, is_passed=is_passed, hour=hour))
    assert store_.stamps() != seen
    first, second = store_.standing("T001").standings
    assert (first.state, first.played, first.done) == (AssignmentState.OPEN, 3, 1)
    assert 0.0 < first.mean < 100.0
    assert second.state is AssignmentState.LOCKED
    assert title_of(first) == "Decide"
    assert progress_of_assignment(first) == "1 of 2 drills in a row passed"
    study.add_drill(drill(20, hour=20))
    standing = store_.standing("T001")
    assert standing.reached == 1
    assert standing.standings[0].reached_utc == drill(20, hour=20).started_utc
    store_.choose(curriculum(mode="hmd"))
    assert store_.standing("T001").standings[0].played == 0
