"""Grades of a course: files that Moodle and Canvas import."""

import numpy as np
import pytest

from rastrainer.decision.drill_score import drill_score
from rastrainer.protocol import RegistrationMethod
from rastrainer.study.database.study import Study
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.export.grades import grade
from Testing.domain.study.played_study import study_with_trials
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.drawn_drills import draw_drill

FIDUCIALS, SURFACE = RegistrationMethod.FIDUCIALS, RegistrationMethod.SURFACE


def past(score, acceptable=True, task="task-1", mode="desktop", method=FIDUCIALS):
    return TrialRow(
        *("T-001", mode, task), values={"score": score}, acceptable=acceptable, method=method
    )


TRIALS = [
    past(60.0),
    past(90.0, task="task-2"),
    past(80.0, mode="hmd"),
    past(99.0, acceptable=False),
    past(95.0, method=SURFACE),
    past(70.0),
]


@pytest.mark.parametrize(
    ("terms", "expected"),
    [
        ((None, None, FIDUCIALS, "best"), 90.0),
        ((None, None, FIDUCIALS, "latest"), 70.0),
        (("task-1", "desktop", FIDUCIALS, "best"), 70.0),
        ((None, None, SURFACE, "best"), 95.0),
        (("task-3", None, FIDUCIALS, "best"), None),
    ],
)
def test_a_grade_is_the_best_or_latest_acceptable_score_of_the_trials_that_count(terms, expected):
    assert grade(TRIALS, *terms) == expected


@pytest.fixture
def place(tmp_path):
    """T001 (who did not consent) has two trials, T002 one, T003 none; T004 is archived."""
    place = tmp_path / "study.db"
    with Study.open(place) as study:
        for name, consent in (("T001", False), ("T002", True), ("T003", True), ("T004", True)):
            study.create_trainee(name, consent=consent)
        for number, (name, seconds) in enumerate(
            (("T001", 110.0), ("T001", 190.0), ("T002", 150.0), ("T004", 150.0))
        ):
            record = make_record(
                trialId=f"00000000-0000-4000-8000-{number:012d}",
                trainee=name,
                startedUtc=f"2999-01-01T10:0{number}:00Z",
                completedUtc=f"2999-01-01T10:0{number}:30Z",
            )
            study.add_trial(record, score=gentle_score(seconds, 0.5))
        study.change_trainee("T004", archived=True)
    return place


def exported(place, *words):
    out = place.with_name("grades")
    assert main(["export", str(place), "-o", str(out), *words]) == 0
    (path,) = out.iterdir()
    return path.name, path.read_text(encoding="utf-8")


def test_moodle_gets_the_id_number_and_a_grade_out_of_100(place, capsys):
    expected = "ID number,RASTrainer\nT001,44.07\nT002,37.26\n"
    assert exported(place, "--grades", "moodle") == ("moodle.csv", expected)
    assert "grades of 2 of 3 trainees" in capsys.readouterr().out


def test_canvas_gets_the_columns_and_the_possible_points_of_its_own_export(place):
    expected = (
        "Student,ID,SIS User ID,SIS Login ID,Section,RASTrainer\n"
        "Points Possible,,,,,100\n"
        "T001,,,T001,,32.13\n"
        "T002,,,T002,,37.26\n"
    )
    words = ("--grades", "canvas", "--rule", "latest", "--task", "task-1")
    assert exported(place, *words) == ("canvas.csv", expected)


def test_drills_give_the_grade_of_their_task_if_they_are_passed(place):
    random = np.random.default_rng(8)
    drills = [draw_drill(random, "T002", day, sensitivity=4.0) for day in (1, 2)]
    drills += [draw_drill(random, "T003", 1, sensitivity=0.2)]
    with Study.open(place) as study:
        for drill in drills:
            study.add_drill(drill)
    scores = [drill_score(drill.cases) for drill in drills]
    assert [score.is_passed for score in scores] == [True, True, False]
    _, text = exported(place, "--grades", "moodle", "--task", "decide")
    best = max(score.score for score in scores[:2])
    assert text == f"ID number,RASTrainer\nT002,{best:.2f}\n"


def test_an_address_that_would_put_a_password_into_every_statement_is_refused(tmp_path, capsys):
    study_with_trials(tmp_path / "study.db")
    words = ["export", str(tmp_path / "study.db"), "-o", str(tmp_path / "out")]
    for address in ("https://me:secret@lab.example.org", "lab.example.org", "https://lab?x"):
        assert main([*words, "--home-page", address]) == 2
        assert "such as https://lab.example.org" in capsys.readouterr().err
    assert main([*words, "--format", "xapi", "--home-page", "https://lab.example.org/"]) == 0
    statements = (tmp_path / "out" / "xapi" / "statements.json").read_text()
    assert '"homePage": "https://lab.example.org"' in statements
