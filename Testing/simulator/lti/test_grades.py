"""Grades reach the gradebook: each is sent until confirmed, none is lost in an outage."""

from __future__ import annotations

import json
import threading
import uuid
from datetime import timedelta

import pytest

from rastrainer.number_text import with_units
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import moment, utc_now
from rastrainer.study.platform_links import PlatformLinks
from rastrainer.study.trainee_data import erase_trainee, export_trainee
from rastrainer_simulator.lti.course_study import FIRST_RETRY_S, LAST_RETRY_S, scores_url
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.simulator.lti.conftest import Lab
from Testing.simulator.lti.platform_double import CLAIM, GRADES


@pytest.fixture
def lab(loop_thread, tmp_path, key_and_study):
    """A lab for each test, whose clock stands until it is set."""
    lab = Lab(loop_thread, tmp_path, *key_and_study)
    yield lab
    lab.close()


def play(lab, pseudonym="T001", time_s=110.0, tre_mm=0.5, score=None, **changes) -> float:
    """Store a scored trial of task 1 on the desktop; return its score."""
    score = score or gentle_score(time_s, tre_mm)
    record = make_record(
        trialId=str(uuid.uuid4()), trainee=pseudonym, startedUtc=utc_now(), **changes
    )
    with Study.open(lab.study) as study:
        study.add_trial(record, score=score)
    return round(score.score, 2)


def skip(lab, seconds: float) -> None:
    """Let time pass for the pauses between tries."""
    grades = lab.tool.server.grades
    now = grades._clock()
    grades._clock = lambda: now + seconds


def test_the_best_acceptable_score_is_sent_once_and_a_better_one_again(lab, browser, platform):
    browser.launch()
    assert lab.tool.send_due() == 0
    first = play(lab)
    assert lab.tool.send_due() == 1
    assert lab.tool.send_due() == 0
    play(lab, time_s=300.0)
    assert lab.tool.send_due() == 0
    better = play(lab, time_s=60.0)
    assert better > first
    assert lab.tool.send_due() == 1
    assert [score["scoreGiven"] for score in platform.scores] == [first, better]
    sent = platform.scores[-1]
    assert sent.pop("timestamp") > platform.scores[0]["timestamp"]
    assert sent == {
        "item": "1",
        "userId": "user-1",
        "scoreGiven": better,
        "scoreMaximum": 100,
        "activityProgress": "Completed",
        "gradingProgress": "FullyGraded",
    }
    assert len(platform.assertions) == 1


def test_only_trials_that_the_link_asks_for_count(lab, browser, platform):
    browser.launch(**{f"{CLAIM}custom": {"task": "task-1", "mode": "desktop", "rule": "latest"}})
    browser.launch(
        **{f"{CLAIM}custom": {}, GRADES: {**endpoint(platform), "lineitem": platform.line_item(2)}}
    )
    play(lab, tre_mm=4.0)
    assert lab.tool.send_due() == 0, "not acceptable"
    best = play(lab, mode="hmd", time_s=50.0)
    latest = play(lab, time_s=200.0)
    play(lab, task="trial-run")
    assert lab.tool.send_due() == 2
    assert [(each["item"], each["scoreGiven"]) for each in platform.scores] == [
        ("1", latest),
        ("2", best),
    ]


def endpoint(platform) -> dict:
    return platform.claims("", "")[GRADES]


def test_the_page_shows_scores_with_units_and_the_grade(lab, browser):
    browser.launch()
    score = play(lab, time_s=110.0)
    play(lab, task="task-2")
    page = browser.launch()[1]
    best = f"Your best acceptable score goes to your course: {score:.1f} / 100."
    assert with_units(best) in page
    assert page.count("<b>Task 1, Desktop</b>") == 1
    assert "Task 2" not in page
    assert with_units(f"{score:.0f} / 100") in page
    assert with_units("110 s") in page


@pytest.mark.parametrize(
    "changes",
    [
        {GRADES: None},
        {GRADES: {"lineitem": "http://127.0.0.1:1/1", "scope": []}},
        {GRADES: {"scope": ["https://purl.imsglobal.org/spec/lti-ags/scope/score"]}},
    ],
    ids=["no service", "no right to it", "no column"],
)
def test_a_link_without_a_gradebook_returns_no_grade_and_says_so(lab, browser, platform, changes):
    assert "returns no grade" in browser.launch(**changes)[1]
    play(lab)
    assert lab.tool.send_due() == 0
    assert platform.assertions == []


def test_a_lab_can_forbid_all_grades(lab, platform):
    lab.new_browser().launch()
    lab.set(sendGrades=False)
    lab.start()
    play(lab)
    assert "returns no grade" in lab.new_browser().launch()[1]
    assert lab.tool.send_due() == 0
    assert platform.scores == []


def test_an_outage_loses_no_grade_and_retries_become_less_frequent(lab, browser, platform):
    skip(lab, 0.0)
    browser.launch()
    score = play(lab)
    platform.planned = [503, 429, 500, 401, 408]
    pauses, pause = [], FIRST_RETRY_S
    while platform.planned:
        left = len(platform.planned)
        assert lab.tool.send_due() == 0
        assert len(platform.planned) == left - 1
        assert lab.tool.send_due() == 0, "before the pause is over"
        assert len(platform.planned) == left - 1
        pauses.append(pause)
        skip(lab, pause + 0.01)
        pause = min(2 * pause, LAST_RETRY_S)
    assert pauses == [2.0, 4.0, 8.0, 16.0, 32.0]
    assert lab.tool.send_due() == 1
    assert [each["scoreGiven"] for each in platform.scores] == [score]


def test_a_platform_may_require_a_different_audience_for_token_requests(lab, browser, platform):
    browser.launch()
    play(lab)
    platform.audience = "https://api.example.org/token"
    lab.set(tokenAudience=platform.audience)
    lab.start()
    assert lab.tool.send_due() == 1


def test_a_platform_that_was_down_gets_the_grade_when_it_is_back(lab, browser, platform):
    browser.launch()
    play(lab)
    platform.token = "another"
    lab.set(tokenUrl="http://127.0.0.1:9/token")
    lab.start()
    assert lab.tool.send_due() == 0
    lab.set()
    lab.start()
    assert lab.tool.send_due() == 1


def test_a_crash_between_sending_and_recording_sends_the_same_grade_again(lab, browser, platform):
    browser.launch()
    score = play(lab)
    platform.planned, platform.stored_first = [500], True
    assert lab.tool.send_due() == 0
    lab.start()
    assert lab.tool.send_due() == 1
    assert [each["scoreGiven"] for each in platform.scores] == [score, score]
    first, second = (each["timestamp"] for each in platform.scores)
    assert first <= second


def test_a_refused_grade_blocks_no_other_and_is_sent_with_the_next_score(lab, browser, platform):
    browser.launch()
    lab.new_browser().launch("user-2")
    play(lab)
    play(lab, "T002")
    platform.planned = [404]
    assert lab.tool.send_due() == 1
    assert lab.tool.send_due() == 0
    assert [each["userId"] for each in platform.scores] == ["user-2"]
    play(lab, time_s=50.0)
    assert lab.tool.send_due() == 1


def test_a_grade_on_which_the_platform_always_fails_blocks_no_other(lab, browser, platform):
    skip(lab, 0.0)
    browser.launch()
    lab.new_browser().launch("user-2")
    play(lab)
    play(lab, "T002")
    platform.planned = [500]
    assert lab.tool.send_due() == 0
    skip(lab, LAST_RETRY_S + 1.0)
    platform.planned = [200, 500]
    assert lab.tool.send_due() == 1
    assert [each["userId"] for each in platform.scores] == ["user-2"]
    skip(lab, LAST_RETRY_S + 1.0)
    assert lab.tool.send_due() == 1


@pytest.mark.parametrize("lasts", [None, "soon", [], 10**400], ids=lambda lasts: str(lasts)[:5])
def test_a_token_with_an_invalid_lifetime_is_requested_again_later(lab, browser, platform, lasts):
    skip(lab, 0.0)
    browser.launch()
    play(lab)
    platform.lasts = lasts
    assert lab.tool.send_due() == 0
    platform.lasts = 3600
    skip(lab, LAST_RETRY_S)
    assert lab.tool.send_due() == 1


def test_a_programming_error_is_logged_and_stops_no_later_grade(
    lab, browser, platform, monkeypatch, caplog
):
    browser.launch()
    play(lab)
    grades, is_sent = lab.tool.server.grades, threading.Event()
    send_due, mistakes = grades.send_due, [ValueError("a mistake")]

    async def fail_once():
        if mistakes:
            raise mistakes.pop()
        await send_due()
        is_sent.set()

    monkeypatch.setattr("rastrainer_simulator.lti.course_study.ROUND_S", 0.01)
    monkeypatch.setattr(grades, "send_due", fail_once)
    lab.thread.call(lab.tool.server.return_grades)
    assert is_sent.wait(60.0)
    assert len(platform.scores) == 1
    assert "a mistake" in caplog.text


def test_a_redirect_that_would_reveal_the_token_is_not_followed(lab, browser, platform):
    browser.launch()
    play(lab)
    platform.planned = [302]
    assert lab.tool.send_due() == 0
    assert platform.scores == []


def test_a_later_grade_has_a_later_time_even_if_the_clock_was_set_back(lab, browser, platform):
    browser.launch()
    play(lab)
    assert lab.tool.send_due() == 1
    links = PlatformLinks(lab.study)
    ((_pseudonym, sent),) = links.assignments()
    ahead = (moment(utc_now()) + timedelta(days=1)).isoformat(timespec="milliseconds")
    links.note_sent(sent, 1.0, ahead)
    assert lab.tool.send_due() == 1
    assert moment(platform.scores[-1]["timestamp"]) == moment(ahead) + timedelta(milliseconds=1)


def test_a_course_that_nobody_has_opened_for_a_long_time_gets_no_more_grades(lab, browser):
    browser.launch()
    play(lab)
    links = PlatformLinks(lab.study)
    ((_pseudonym, assignment),) = links.assignments()
    long_ago = (moment(utc_now()) - timedelta(days=181)).isoformat()
    links.put(type(assignment)(**{**vars(assignment), "launched_utc": long_ago}))
    assert lab.tool.send_due() == 0
    browser.launch()
    assert lab.tool.send_due() == 1


def test_deleting_a_trainee_deletes_who_they_were_on_the_platform(lab, browser, tmp_path):
    browser.launch("user-7654321")
    assert PlatformLinks(lab.study).pseudonyms() == {"T001"}
    with Study.open(lab.study) as study:
        export_trainee(study, "T001", tmp_path / "data.json")
        erase_trainee(study, "T001", None)
    assert PlatformLinks(lab.study).pseudonyms() == set()
    exported = json.loads((tmp_path / "data.json").read_text())["learning_platforms"]
    assert exported == [{"issuer": lab.platform.address, "subject": "user-7654321"}]
    assert b"user-7654321" not in PlatformLinks(lab.study).path.read_bytes()


def test_the_address_for_scores_keeps_the_query_of_the_column():
    assert scores_url("https://m.example.org/1/lineitem?type_id=3") == (
        "https://m.example.org/1/lineitem/scores?type_id=3"
    )
    assert scores_url("https://c.example.org/1/") == "https://c.example.org/1/scores"
