"""The report of a study: the paper's tables, self-contained, escaped and complete."""

import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.outcomes import MAIN_OUTCOMES
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.study_data import StudyData, read_study_data
from rastrainer.trial.scoring import LONG_PAUSE_S
from rastrainer.trial.trial_feedback import competence_of
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.report.comparisons import compare_modes, mode_delays, paired_means
from rastrainer_simulator.report.published_tables import with_ctps
from rastrainer_simulator.report.report import report_html
from rastrainer_simulator.virtual.outcome_model import OutcomeModel
from Testing.domain.study.played_study import STUDIES, study_with_trials
from Testing.drawn_drills import draw_drill
from Testing.drawn_study import draw_study

PUBLISHED = STUDIES / "published.csv"
VOID = {"meta", "br", "img", "hr", "link", "input"}


class Balanced(HTMLParser):
    """Fails on unbalanced tags."""

    def __init__(self):
        super().__init__()
        self.open, self.texts = [], []

    def handle_starttag(self, tag, _attributes):
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, _tag, _attributes):
        pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data)


def words_of(html):
    parser = Balanced()
    parser.feed(html)
    assert parser.open == []
    return re.sub(r"\s+", " ", " ".join(parser.texts))


@pytest.fixture(scope="module")
def published():
    return read_study_data(PUBLISHED)


@pytest.fixture(scope="module")
def page(published):
    return report_html(published, "today")


def cohort(trainees, tasks=3, seed=0, learning=0.0):
    rng = np.random.default_rng(seed)
    rows = []
    for index in range(trainees):
        for mode, shift in (("desktop", 0.0), ("hmd", 0.4)):
            for number in range(1, tasks + 1):
                time = 80 + 60 * number**-learning + rng.normal(0, 3)
                values = {
                    "completion_time_s": time,
                    "rmse_mm": 1.5 + shift + rng.normal(0, 0.2),
                    "score": 60.0 + rng.normal(0, 5),
                    "sparc": -3 + rng.normal(0, 0.3),
                }
                utc = f"2026-05-01T09:{number:02d}:00Z"
                who = f"T{index:03d}", mode, f"task-{number}", number
                rows.append(TrialRow(*who, values, started_utc=utc))
    return StudyData("A cohort", tuple(rows), has_order=True)


def test_both_tables_are_the_papers_to_the_printed_digit(page):
    words = words_of(page)
    for row in (
        "Task 1 114.30 1.10 101.40 1.16 102.00 1.15 105.20 1.17 79.70",
        "Task 5 127.00 2.31 133.40 1.48 156.50 1.50 144.00 1.51 56.59",
        "User Perf. 63.76 66.31 65.12 64.09",
        "Task 2 147.70 1.15 114.80 1.13 132.80 1.15 125.10 1.18 86.42",
        "User Perf. 81.72 58.83 68.37 60.22 67.29",
    ):
        assert row in words
    assert "67.29 ± 25.96" in words
    assert "r = 0.963, r² = 0.928" in words
    # What four subjects cannot show is said, too.
    assert "0.147 mm higher with the headset than with the desktop screen" in words
    assert "95 % interval from +0.085 to +0.208 mm" in words
    assert "compatible with anything from −20.46 to +13.94 s" in words
    assert "its smallest possible p is .125" in words
    assert "None are reported. Groups of trainees are not reported for fewer than 12" in words


def test_the_papers_inconsistencies_are_reported_with_its_numbers(page):
    words = words_of(page)
    assert '"R²" of task number and completion time, HMD 5 task means 0.96 0.9633' in words
    assert "Overall CTPS, HMD 20 trials 64.81 64.818" in words
    assert "± of the overall CTPS, desktop 20 trials 25.96 25.963" in words
    assert "r = −.75 (HMD, p = .15) and −.61 (desktop, p = .27)" in words
    assert "CTPS r = −0.75 [−0.982, 0.396], p = .146" in words


def test_the_page_is_self_contained_accessible_and_has_no_scripts(page):
    assert "<script" not in page
    assert not re.findall(r'(?:src|href)="(?!#)', page)
    links = set(re.findall(r"https?://[^\s\"'<]+", page))
    assert links == {"http://www.w3.org/2000/svg"}
    heads = re.findall(r"<th[ >][^>]*>?", page)
    assert len(heads) > 70
    assert all(re.search(' scope="(col|colgroup|row)"', head) for head in heads)


@pytest.mark.usefixtures("undrawn")
def test_a_balanced_order_of_modes_separates_the_period_and_is_tabulated():
    model = OutcomeModel([120.0] * 5, [1.5] * 5, learning=0.3, carries_practice=True)
    modes = ("desktop", "hmd")
    orders = [modes[:: -1 if place % 2 else 1] for place in range(12)]
    study = draw_study(model, 12, modes, np.random.default_rng(1), orders)
    assert mode_delays(study, *modes) == {
        f"V{place + 1:04d}": -1.0 if place % 2 else 1.0 for place in range(12)
    }
    words = words_of(report_html(study, "today"))
    assert "What the order of the modes did" in words
    assert "Completion time, s 6 6 −" in words
    fixed_order = draw_study(model, 12, modes, np.random.default_rng(1))
    words = words_of(report_html(fixed_order, "today"))
    assert "What the order of the modes did" not in words
    assert "does not allow the effect of the period" in words.split("Performance")[0]


@pytest.mark.usefixtures("undrawn")
def test_trainees_are_compared_on_the_tasks_done_in_both_modes():
    played = ("desktop", "1", 10.0), ("desktop", "2", 90.0), ("hmd", "1", 12.0)
    rows = [TrialRow("a", mode, task, 1, {"completion_time_s": s}) for mode, task, s in played]
    data = StudyData("x", tuple(rows))
    assert paired_means(data, "completion_time_s", "desktop", "hmd") == {"a": (10.0, 12.0)}
    missing = "Trials are missing: Task 2, Headset (HMD), of 1 of 1 trainee."
    assert missing in words_of(report_html(data))


def test_registering_and_scoring_import_no_scipy():
    modules = "rastrainer.trial.analysis, rastrainer.trial.trial_feedback, rastrainer.trial.ctps"
    script = (
        f"import sys; sys.modules['scipy'] = None; import {modules}; "
        "from rastrainer_simulator.cli.main import main; "
        f"sys.exit(main(['score', {str(PUBLISHED)!r}]))"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_every_chart_is_well_formed_and_has_a_description(page):
    drawn = re.findall(r"<svg.*?</svg>", page, re.DOTALL)
    assert len(drawn) >= 10
    for chart in drawn:
        root = ElementTree.fromstring(chart)
        assert root.get("aria-label")
        width, height = map(float, root.get("viewBox").split()[2:])
        for element in root:
            for name, limit in (("x", width), ("cx", width), ("y", height), ("cy", height)):
                if element.get(name) is not None:
                    assert -1 <= float(element.get(name)) <= limit + 1


@pytest.mark.usefixtures("undrawn")
def test_the_command_writes_the_page_and_the_numbers(tmp_path, capsys):
    assert main(["report", str(PUBLISHED), "-o", str(tmp_path / "new" / "folder")]) == 0
    folder = tmp_path / "new" / "folder"
    assert "40 trials" in capsys.readouterr().out
    assert (folder / "report.html").read_text().startswith("<!DOCTYPE html>")
    assert len((folder / "trials.csv").read_text().splitlines()) == 41
    for words, sentence in (
        ([str(PUBLISHED), "--mean-ct", "vr=1"], "names the mode 'vr'"),
        ([str(STUDIES / "README.md")], "is not a study database"),
    ):
        assert main(["report", *words, "-o", str(tmp_path)]) == 2
        assert sentence in capsys.readouterr().err


@pytest.mark.usefixtures("undrawn")
def test_a_large_cohort_gets_tables_curves_and_a_methods_paragraph():
    page = report_html(cohort(12, tasks=8, learning=0.7), "today")
    words = words_of(page)
    assert "12 users:" in words
    assert "the means follow a·n^−b + c" in words
    assert "Completion time, s Desktop 12 8 139.8 93.0 −45.8 [" in words
    assert "< .001 < .001 12 / 0 / 0" in words
    assert "12 trainees did 192 trials" in words


@pytest.mark.usefixtures("undrawn")
def test_trials_with_long_pauses_are_reported_as_a_limitation():
    def row(number, paused):
        values = {"completion_time_s": 10.0, "pause_time_s": paused}
        return TrialRow("a", "desktop", "1", number, values)

    once = StudyData("x", (row(1, LONG_PAUSE_S), row(2, LONG_PAUSE_S + 1.0)))
    assert "1 of 2 trials were paused for more than 30 s in all" in words_of(report_html(once))
    never = StudyData("x", (row(1, 0.0),))
    assert "were paused" not in words_of(report_html(never))


@pytest.mark.usefixtures("undrawn")
def test_passed_trials_and_competent_trainees_are_counted():
    rows = []
    for trainee, score, acceptable in (("A", 70.0, True), ("B", 69.9, True), ("C", 90.0, False)):
        for number in range(1, 31):
            rows.append(scored(trainee, number, score, acceptable=acceptable))
    protocol = replace(StudyProtocol.read(STUDIES / "published-protocol.json"), pass_mark=70.0)
    words = words_of(report_html(StudyData("One mode", tuple(rows), protocol=protocol)))
    assert "passes with 70 of 100 points (set by the protocol)" in words
    assert "Fewer than 11 trials in a mode cannot show it" in words
    assert (
        "10 passed trials would be reached by chance, within 30 trials, by 5.8 % of those" in words
    )
    shown_at = competence_of([False] * 30).competent_at
    assert 1 < shown_at < 30
    assert f"90 30 (33 %) 1 of 3 {shown_at} " in words


def scored(trainee, number, score, method="fiducials", acceptable=True):
    values = {"completion_time_s": 90.0, "rmse_mm": 1.0, "score": score}
    utc = f"2026-05-{number:02d}T09:00:00Z"
    others = {"method": method, "acceptable": acceptable, "started_utc": utc}
    return TrialRow(trainee, "hmd", "task-1", number, values, **others)


@pytest.mark.usefixtures("undrawn")
def test_a_pass_mark_of_fiducials_passes_no_trial_of_another_method_and_the_report_says_so():
    published = StudyProtocol.read(STUDIES / "published-protocol.json")
    protocol = replace(published, pass_mark=65.0)
    rows = tuple(scored("A", number, 80.0, "surface") for number in range(1, 31))
    words = words_of(report_html(StudyData("One", rows, protocol=protocol)))
    assert "pass mark of 65 points is for trials registered by fiducials" in words
    assert "these were registered by surface. Their scores do not compare" in words
    assert "30 (100 %)" not in words
    assert "LC-CUSUM of every trainee" not in words


@pytest.mark.usefixtures("undrawn")
def test_a_report_of_a_database_has_scores_motion_questionnaires_and_skipped_steps(tmp_path):
    study_with_trials(tmp_path / "study.db")
    data = read_study_data(tmp_path / "study.db")
    assert data.trials[0].values["sparc"] == -2.5
    words = words_of(report_html(data))
    assert "Simulator sickness (SSQ) before Headset (HMD) 1 78.5" in words
    assert "B, desktop/trial-run: knows the tasks from a pilot" in words
    assert "The order of modes was balanced" in words
    assert "simulator 0.1.0" in words
    assert [(trial.trainee, trial.mode) for trial in data.trials] == [
        ("A", "hmd"),
        ("A", "desktop"),
        ("B", "desktop"),
    ]
    assert "Left out: 1 trial that the protocol had not asked for." in words
    with Study.open(tmp_path / "study.db") as study:
        study.change_trainee("A", consent=False)
    data = read_study_data(tmp_path / "study.db")
    assert (data.trainees, data.answers) == (("B",), ())
    assert data.without_consent == 1
    with Study.open(tmp_path / "study.db") as study:
        study.change_trainee("B", consent=False)
    with pytest.raises(InputError, match=r"2 did not\): note in 3D Slicer, Trainees"):
        read_study_data(tmp_path / "study.db")


def test_names_are_texts_whatever_they_contain(recwarn):
    odd = "任务 $\\frac{1}$ & <script>alert(1)</script>"
    rows = [
        TrialRow(
            *(odd, odd, odd, number),
            {"completion_time_s": 10.0 + number, "rmse_mm": 1.0},
            started_utc="2026-05-01T09:00:00Z",
        )
        for number in range(1, 4)
    ]
    drills = tuple(draw_drill(np.random.default_rng(2), odd, day) for day in (1, 2))
    page = report_html(StudyData(odd, tuple(rows), has_order=True, drills=drills), "today")
    shown = [
        "".join(text.itertext())
        for chart in re.findall(r"<svg.*?</svg>", page, re.DOTALL)
        for text in ElementTree.fromstring(chart).iter("{http://www.w3.org/2000/svg}text")
    ]
    assert any(odd in text for text in shown)
    assert "<script" not in page
    assert "&lt;script&gt;" in page
    assert [str(each.message) for each in recwarn if "Glyph" in str(each.message)] == []


def test_ctps_is_not_tested_because_it_differs_between_equal_modes_far_too_often():
    modes = ("desktop", "hmd")
    drawn = draw_study(OutcomeModel([120.0] * 3, [1.5] * 3), 12, modes, np.random.default_rng(16))
    (found,) = (c for c in compare_modes(with_ctps(drawn), MAIN_OUTCOMES, *modes) if c.reason)
    assert (found.outcome.name, found.result) == ("ctps", None)
