"""The group Curriculum by its buttons alone: set for one or all, shown, ended."""

import uuid
from pathlib import Path

import pytest

from rastrainer.json_records import record_to_json
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import day_of
from rastrainer_simulator.board.class_table import ClassReader, class_table
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.simulator.board.class_study import as_in_narrow_columns

SHIPPED = Path(__file__).parents[2] / "assets" / "studies" / "example-curriculum.json"


@pytest.fixture
def panel(host):
    """The module with Trainees, Study and Curriculum open, and the trainees T001 and T002."""
    host.open()
    for section in ("trainees", "study", "curriculum"):
        host.find(f"{section}CollapsibleButton").collapsed = False
    host.process_events()
    host.press("createTraineeButton")
    host.press("createTraineeButton")
    return host


def cells(host, name):
    table = host.find(name)
    columns = range(table.columnCount)
    return [[table.item(row, column).text() for column in columns] for row in range(table.rowCount)]


def test_a_curriculum_is_set_for_a_trainee_shown_and_ended(panel):
    assert panel.text("curriculumText") == "No curriculum: trainees choose what they practice."
    with pytest.raises(AssertionError, match="Choose the file of a curriculum first"):
        panel.press("setCurriculumButton")
    panel.type("curriculumPathLineEdit", str(SHIPPED.with_name("published-protocol.json")))
    panel.press("setCurriculumButton")
    assert "use name, title, assignments" in panel.messages[-1].text
    panel.type("curriculumPathLineEdit", str(SHIPPED))
    panel.press("setCurriculumButton")
    assert panel.text("curriculumText") == (
        "First steps: 0 of 6 reached. Next: Task 1, which has not been played yet."
    )
    rows = cells(panel, "assignmentsTable")
    assert rows[0] == ["Task 1", "0 of 2", "–"]
    assert rows[1][1] == "locked"
    tip = panel.find("assignmentsTable").item(1, 0).toolTip()
    assert "second-points: locked until first-points is reached, 0 of 2 trials in a row" in tip
    assert cells(panel, "classTable") == [["T002", "0 / 6", "Task 1"]]
    panel.answer("End the curriculum of T002?", "Yes")
    panel.press("endCurriculumButton")
    assert panel.text("curriculumText").startswith("No curriculum")
    with pytest.raises(AssertionError, match="There is no curriculum to end"):
        panel.press("endCurriculumButton")


def test_a_curriculum_for_everybody_shows_the_class_as_a_board_does_and_follows_what_arrives(panel):
    panel.type("curriculumPathLineEdit", str(SHIPPED))
    panel.choose("traineeComboBox", "Choose a trainee")
    with pytest.raises(AssertionError, match="Choose a trainee in the section"):
        panel.press("setCurriculumButton")
    panel.press("everybodyCheckBox")
    panel.press("setCurriculumButton")
    assert [row[0] for row in cells(panel, "classTable")] == ["T001", "T002"]
    panel.choose("traineeComboBox", "T001")
    with Study.open(panel.find("studyPathLineEdit").currentPath) as study:
        for _ in range(2):
            record = make_record(trialId=str(uuid.uuid4()), trainee="T001")
            study.add_trial(record, score=gentle_score(60.0, 0.2))
    panel.widget.logic.session.trainees.changed.emit()
    panel.process_events()
    day = day_of(make_record()["startedUtc"])
    assert cells(panel, "assignmentsTable")[0][:2] == ["Task 1", f"reached {day}"]
    shown = cells(panel, "classTable")
    assert shown[0][1] == "1 / 6"
    reader = ClassReader(Path(panel.find("studyPathLineEdit").currentPath))
    table = record_to_json(*class_table(reader.read(), "en"), with_defaults=True)
    reader.close()
    assert shown == [
        [row["trainee"], f"{row['reached']} / {len(row['cells'])}", row["next"]]
        for row in table["trainees"]
    ]
    chosen = list(map(as_in_narrow_columns, table["trainees"][0]["cells"]))
    assert chosen == [row[1] for row in cells(panel, "assignmentsTable")]
