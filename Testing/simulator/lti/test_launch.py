"""A course launches the tool: each learner gets a pseudonym, and sees what to do."""

from __future__ import annotations

import os
import stat

import jwt

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.platform_links import PlatformLinks
from rastrainer_simulator.lti.course_study import CourseStudy
from rastrainer_simulator.lti.lti_server import COOKIE
from Testing.simulator.lti.conftest import ADDRESS
from Testing.simulator.lti.platform_double import CLAIM, KEY, KEY_ID

INSTRUCTOR = "http://purl.imsglobal.org/vocab/lis/v2/membership#Instructor"


def pseudonym_in(page: str) -> str:
    return page.partition("<strong>")[2].partition("</strong>")[0]


def test_the_browser_is_sent_to_the_platform_with_everything_it_must_return(browser, platform):
    status, headers, _text = browser.begin()
    assert status == 302
    assert headers["Location"].startswith(f"{platform.address}/auth?site=1&")
    asked = browser.login()
    assert asked["redirect_uri"] == f"{ADDRESS}/launch"
    assert (asked["response_type"], asked["response_mode"]) == ("id_token", "form_post")
    assert (asked["login_hint"], asked["lti_message_hint"]) == ("hint", "message")
    cookie = headers["Set-Cookie"]
    assert cookie.startswith(f"{COOKIE}=")
    assert all(word in cookie for word in ("HttpOnly", "Secure", "SameSite=None", "Path=/"))


def test_a_learner_gets_the_next_pseudonym_and_the_same_one_again(lab, browser):
    status, page = browser.launch()
    assert status == 200
    first = pseudonym_in(page)
    assert first == lab.trainees()[-1]
    assert pseudonym_in(lab.new_browser().launch()[1]) == first
    second = pseudonym_in(lab.new_browser().launch("user-2")[1])
    assert lab.trainees()[-2:] == [first, second]
    with Study.open_for_reading(lab.study) as study:
        assert not study.trainee(first).consent


def test_the_study_knows_no_platform_user_and_no_names_are_stored(lab, browser):
    browser.launch("user-1234567")
    links = PlatformLinks(lab.study).path
    assert b"user-1234567" in links.read_bytes()
    assert os.name != "posix" or stat.S_IMODE(links.stat().st_mode) == 0o600
    assert b"user-1234567" not in lab.study.read_bytes()
    for path in (links, lab.study):
        assert b"Jo Doe" not in path.read_bytes()
        assert b"jo@example.org" not in path.read_bytes()


def test_a_deleted_trainee_is_forgotten_and_returns_as_somebody_new(lab, browser):
    first = pseudonym_in(browser.launch("user-7654321")[1])
    other = pseudonym_in(browser.launch("user-8765432")[1])
    with Study.open(lab.study) as study:
        study.delete_trainee(first)
        assert pseudonym_in(browser.launch("user-7654321")[1]) > other
        study.delete_trainee(other)
    assert lab.tool.send_due() == 0
    assert b"user-8765432" not in PlatformLinks(lab.study).path.read_bytes()


def test_a_learner_who_launches_while_deleted_ones_are_removed_is_kept(lab, browser, monkeypatch):
    pseudonyms = []

    def linked_now():
        pseudonyms.append(pseudonym_in(browser.launch("user-late")[1]))
        return PlatformLinks(lab.study).pseudonyms()

    # As another process on the same study.
    course = CourseStudy(lab.study)
    monkeypatch.setattr(course._links, "pseudonyms", linked_now)
    course.forget_deleted()
    course.close()
    assert [pseudonym_in(browser.launch("user-late")[1])] == pseudonyms


def test_a_link_that_cannot_be_written_leaves_no_trainee_behind(lab, browser, monkeypatch):
    before = lab.trainees()

    def full(*_link):
        raise InputError("The disk is full.")

    with monkeypatch.context() as patched:
        patched.setattr(PlatformLinks, "link", full)
        for _click in range(3):
            assert browser.launch("user-unlinked")[0] == 503
    assert lab.trainees() == before
    assert browser.launch("user-unlinked")[0] == 200


def test_a_teacher_sees_what_the_link_asks_for_and_gets_no_pseudonym(lab, browser):
    before = lab.trainees()
    status, text = browser.launch(**{f"{CLAIM}roles": [INSTRUCTOR]})
    assert status == 200
    assert "Play Task 1 on the desktop screen" in text
    assert lab.trainees() == before


def test_the_page_speaks_the_language_of_the_platform_or_of_the_browser(browser):
    said = browser.launch(**{f"{CLAIM}launch_presentation": {"locale": "de-AT"}})[1]
    assert '<html lang="de">' in said
    assert "Dein Pseudonym" in said
    for locale, language in (("de_du", "de"), ("zh_cn", "zh-Hans"), ("", "en"), ("deu", "en")):
        said = browser.launch(**{f"{CLAIM}launch_presentation": {"locale": locale}})[1]
        assert f'<html lang="{language}">' in said
    assert "Votre pseudonyme" in browser.launch(language="xx,fr-CA;q=0.8,en;q=0.5")[1]


def test_the_page_may_not_be_framed_run_scripts_or_be_cached(browser, platform):
    asked = browser.login()
    claims = platform.claims(asked["nonce"], browser.launch_url)
    token = jwt.encode(claims, KEY, headers={"kid": KEY_ID}, algorithm="RS256")
    form = {"state": asked["state"], "id_token": token}
    status, headers, _text = browser.ask("/launch", "POST", form)
    assert status == 200
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert headers["Cache-Control"] == "no-store"
    assert headers["X-Content-Type-Options"] == "nosniff"


def test_text_from_a_platform_is_shown_as_text_and_not_as_markup(browser):
    custom = {"task": "<script>alert(1)</script>"}
    status, text = browser.launch(**{f"{CLAIM}custom": custom})
    assert status == 200
    assert "<script" not in text


def test_lab_side_failures_are_logged_and_not_revealed_to_visitors(lab, browser, caplog):
    links = PlatformLinks(lab.study).path
    kept = links.read_bytes()
    links.write_bytes(b"no database" * 100)
    status, text = browser.launch()
    links.write_bytes(kept)
    assert status == 503
    assert links.name not in text
    assert links.name in caplog.text
