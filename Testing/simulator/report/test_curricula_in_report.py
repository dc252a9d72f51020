"""The report says where trainees who agreed stand in their curricula."""

import re
from pathlib import Path

import pytest

from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.report.report import report_html
from rastrainer_simulator.report.trainees import curricula
from Testing.domain.study.played_study import study_with_trials
from Testing.simulator.report.test_report import words_of

pytestmark = pytest.mark.usefixtures("undrawn")

SHIPPED = Path(__file__).parents[3] / "assets" / "studies" / "example-curriculum.json"


def test_each_trainee_has_a_row_and_each_goal_a_sentence(tmp_path):
    path = tmp_path / "study.db"
    study_with_trials(path, consent=False)
    assert curricula(read_study_data(path)) == ""
    with Study.open(path) as study:
        CurriculumStore(study).choose(Curriculum.read(SHIPPED))
    page = report_html(read_study_data(path))
    (found,) = re.findall(r"<section><h2>Curriculum</h2>.*?</section>", page, re.DOTALL)
    words = words_of(found)
    assert words.startswith("Curriculum First steps trainee trials (n) reached first-points")
    assert " B 1 0 of 6 0 of 2 locked locked locked locked locked " in words
    assert " A " not in words
    assert (
        "by-surface: Task 3 by a trace over the skin, 2 trials in a row at 60 or more; after "
        in words
    )
    assert "competent: Task 4, competence (LC-CUSUM), a trial passes at 70 or more; after" in words
