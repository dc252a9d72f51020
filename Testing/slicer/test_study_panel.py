"""The section Study by its buttons alone: start, enroll, answer, skip, set a curriculum."""

import json
import uuid
from datetime import datetime, timezone
from pathlib import Path

import pytest

from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import StepKind
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.questionnaires import SSQ
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.board.class_table import ClassReader, class_table
from Testing.domain.trial.trial_records import gentle_score, make_aborted, make_record
from Testing.simulator.board.class_study import as_in_narrow_columns

SHIPPED = Path(__file__).parents[2] / "assets" / "studies" / "published-protocol.json"
CURRICULUM = SHIPPED.with_name("example-curriculum.json")


@pytest.fixture
def panel(fresh_module):
    """The module with the section Study open, and a trainee T001."""
    fresh_module.unfold("protocolText")
    fresh_module.press("createTraineeButton")
    return fresh_module


@pytest.fixture
def begun(panel):
    panel.type("protocolPathLineEdit", str(SHIPPED))
    panel.answer("Begin the study", "Yes")
    panel.press("beginStudyButton")
    panel.press("enrollButton")
    return panel


def entries(host):
    with Study.open(host.find("studyPathLineEdit").currentPath) as study:
        return [(e.step, e.outcome) for e in StudyProgress(study).progress("T001").entries]


def skip_to_a_trial(host):
    """Skip every step before the first trial; return that step."""
    study = host.widget.logic.session.study
    while study.progress().next_step.kind is not StepKind.TRIAL:
        host.answer("Why is it skipped?", "this is not what is tested")
        host.press("skipStepButton")
    return study.progress().next_step


def outcomes(host):
    return [row[1] for row in host.cells("stepsTable")]


def test_a_study_begins_with_a_protocol_only_after_confirmation(panel, tmp_path):
    assert "practice freely" in panel.text("protocolText")
    with pytest.raises(AssertionError, match="Choose the file of a protocol first"):
        panel.press("beginStudyButton")
    (tmp_path / "wrong.json").write_text(
        json.dumps({"formatVersion": 1, "scoreVersion": "1", "steps": []})
    )
    panel.type("protocolPathLineEdit", str(tmp_path / "wrong.json"))
    panel.answer("Begin the study", "Yes")
    panel.press("beginStudyButton")
    assert 'there is no "steps"' in panel.messages[-1].text
    panel.type("protocolPathLineEdit", str(SHIPPED))
    panel.answer("Begin the study", "No")
    panel.press("beginStudyButton")
    assert "practice freely" in panel.text("protocolText")
    panel.answer("Begin the study", "Yes")
    panel.press("beginStudyButton")
    assert panel.text("protocolText") == "Desktop against headset, after the published study"


def test_a_questionnaire_is_a_form_that_keeps_no_partial_answers(begun):
    assert begun.text("stepText") == "Step 1 of 19: Answer the questionnaire SSQ."
    begun.choose("ssq_nauseaComboBox", "2")
    begun.press("saveAnswersButton")
    assert "SSQ: not answered yet: 1, 2, 3, 4, 5, 6, 7, 9" in begun.messages[-1].text
    assert begun.find("ssq_nauseaComboBox").currentText == "2"
    for item in SSQ.items:
        begun.choose(f"{item.name}ComboBox", "1")
    begun.press("saveAnswersButton")
    assert entries(begun) == [("hmd/before/ssq", "done")]
    assert outcomes(begun)[:3] == ["done", "next", ""]


def test_a_step_is_skipped_only_with_a_reason_and_started_only_in_its_turn(begun):
    begun.answer("Why is it skipped?", "no sheets")
    begun.answer("only with a reason", "the sheets were missing")
    begun.press("skipStepButton")
    assert begun.messages[-1].details == "no sheets"
    assert outcomes(begun)[:2] == ["skipped: the sheets were missing", "next"]
    assert begun.text("stepTimeText") == "0:00 of 5 min have passed."
    with pytest.raises(AssertionError, match="Connect to the simulator first"):
        begun.press("startStepButton")


def test_the_panel_says_why_a_trial_did_not_count_and_asks_why_an_aborted_one_is_repeated(begun):
    study, step = begun.widget.logic.session.study, skip_to_a_trial(begun)
    started = datetime.now(timezone.utc).isoformat()
    record = make_record(trainee="T001", mode=step.mode, task=step.task, startedUtc=started)
    with Study.open(begun.find("studyPathLineEdit").currentPath) as elsewhere:
        elsewhere.add_trial(record, score=None)
    study.leadOn("T001")
    assert "The last trial did not count: it cannot be registered" in begun.text("stepText")
    assert study.progress().next_step == step
    started = datetime.now(timezone.utc).isoformat()
    record = make_aborted(
        trainee="T001", mode=step.mode, task=step.task, startedUtc=started, touches=15
    )
    with Study.open(begun.find("studyPathLineEdit").currentPath) as elsewhere:
        elsewhere.add_aborted(record)
    begun.widget.logic.session.trials.abortedKept.emit(record_from_json(AbortedTrial, record))
    begun.process_events()
    assert "aborted with 15 of 15 points touched" in begun.text("stepText")
    text = "Aborted: 1, of them 1 after all touches"
    begun.wait_until(lambda: text in begun.text("traineeText"), "it is counted")
    assert not begun.find("startStepButton").visible
    begun.answer("Why is the aborted trial repeated?", "no reason")
    begun.answer("only with a reason", "the tracking of the headset was lost")
    begun.press("repeatStepButton")
    assert begun.find("startStepButton").visible
    with Study.open(begun.find("studyPathLineEdit").currentPath) as elsewhere:
        (stored,) = elsewhere.aborted("T001")
    assert stored.repeat_reason == "the tracking of the headset was lost"


@pytest.fixture
def classroom(panel):
    """The module with the part open, and another trainee, T002."""
    panel.find("curriculumCollapsibleButton").collapsed = False
    panel.press("createTraineeButton")
    return panel


def test_a_curriculum_is_set_for_a_trainee_shown_and_ended(classroom):
    assert classroom.text("curriculumText") == "No curriculum: trainees choose what they practice."
    with pytest.raises(AssertionError, match="Choose the file of a curriculum first"):
        classroom.press("setCurriculumButton")
    classroom.type("curriculumPathLineEdit", str(CURRICULUM.with_name("published-protocol.json")))
    classroom.press("setCurriculumButton")
    assert "use name, title, assignments" in classroom.messages[-1].text
    classroom.type("curriculumPathLineEdit", str(CURRICULUM))
    classroom.press("setCurriculumButton")
    assert classroom.text("curriculumText") == (
        "First steps: 0 of 6 reached. Next: Task 1, which has not been played yet."
    )
    tip = classroom.find("assignmentsTable").item(1, 0).toolTip()
    assert "second-points: locked until first-points is reached, 0 of 2 trials in a row" in tip
    assert classroom.cells("classTable") == [["T002", "0 / 6", "Task 1"]]
    classroom.answer("End the curriculum of T002?", "Yes")
    classroom.press("endCurriculumButton")
    assert classroom.text("curriculumText").startswith("No curriculum")
    with pytest.raises(AssertionError, match="There is no curriculum to end"):
        classroom.press("endCurriculumButton")


def test_a_curriculum_for_everybody_shows_the_class_as_a_board_does_and_follows_what_arrives(
    classroom,
):
    classroom.type("curriculumPathLineEdit", str(CURRICULUM))
    classroom.choose("traineeComboBox", "Choose a trainee")
    with pytest.raises(AssertionError, match="Choose a trainee in the section"):
        classroom.press("setCurriculumButton")
    classroom.press("everybodyCheckBox")
    classroom.press("setCurriculumButton")
    assert [row[0] for row in classroom.cells("classTable")] == ["T001", "T002"]
    classroom.choose("traineeComboBox", "T001")
    with Study.open(classroom.find("studyPathLineEdit").currentPath) as study:
        for _ in range(2):
            record = make_record(trialId=str(uuid.uuid4()), trainee="T001")
            study.add_trial(record, score=gentle_score(60.0, 0.2))
    classroom.widget.logic.session.trainees.changed.emit()
    classroom.process_events()
    shown = classroom.cells("classTable")
    assert shown[0][1] == "1 / 6"
    reader = ClassReader(Path(classroom.find("studyPathLineEdit").currentPath))
    table = record_to_json(*class_table(reader.read(), "en"), with_defaults=True)
    reader.close()
    assert shown == [
        [row["trainee"], f"{row['reached']} / {len(row['cells'])}", row["next"]]
        for row in table["trainees"]
    ]
    chosen = list(map(as_in_narrow_columns, table["trainees"][0]["cells"]))
    assert chosen == [row[1] for row in classroom.cells("assignmentsTable")]
