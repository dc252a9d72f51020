"""A course of Open edX launches RASTrainer in a browser and gets grades, by its own messages."""

from __future__ import annotations

import base64
import json
import os
import re
import signal
import subprocess
import sys
import time
import urllib.request
import uuid
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

import pytest
from playwright.sync_api import sync_playwright

from rastrainer.study.database.database import StudyPlace
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import utc_now
from rastrainer_simulator.lti.settings import SETTINGS_FILE
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.free_port import free_port
from Testing.web.chromium import PATIENCE_MS, launch

# Open edX has its own environment, which `make soak` makes.
pytestmark = pytest.mark.soak

PYTHON = Path(sys.prefix) / "openedx" / "bin" / "python"
PLATFORM = Path(__file__).with_name("open_edx_platform.py")
COMMAND = [sys.executable, "-m", "rastrainer_simulator.cli.main", "lti"]
WITHIN_S = 300.0


class Started:
    """A program that is started repeatedly."""

    def __init__(self, *command: object, ready: str, home: Path):
        self._command, self._ready = [str(word) for word in command], ready
        self._environment = os.environ | {"HOME": str(home)}
        self.start()

    def start(self) -> None:
        self._process = subprocess.Popen(
            self._command, stdout=subprocess.PIPE, text=True, env=self._environment
        )
        line = self._process.stdout.readline()
        assert line.startswith(self._ready), line

    def kill(self) -> None:
        if self._process.returncode is None:
            self._process.kill()
            self._process.communicate()

    def stop(self) -> int:
        self._process.send_signal(signal.SIGTERM)
        self._process.communicate()
        return self._process.returncode


class Course:
    """Platform, tool and study."""

    def __init__(self, folder: Path, study: StudyPlace):
        self.study = study
        Study.open(self.study).close()
        port, platform_port = free_port(), free_port()
        self.tool_url = f"http://127.0.0.1:{port}"
        self.url = f"http://localhost:{platform_port}"
        self.platform = Started(
            PYTHON, PLATFORM, platform_port, folder, self.tool_url, ready="ready", home=folder
        )
        settings = {"address": self.tool_url, "platforms": [self.ask("/registration")]}
        (folder / SETTINGS_FILE).write_text(json.dumps(settings))
        words = [*COMMAND, self.study, "--port", port, "--config", folder]
        self.tool = Started(*words, ready="RASTrainer LTI listens on", home=folder)

    def ask(self, path: str) -> dict:
        with urllib.request.urlopen(f"{self.url}{path}", timeout=WITHIN_S) as answer:
            return json.load(answer)

    def play(self, pseudonym: str, time_s: float) -> float:
        """Store a scored trial; return its score."""
        score = gentle_score(time_s, 0.5)
        record = make_record(trialId=str(uuid.uuid4()), trainee=pseudonym, startedUtc=utc_now())
        with Study.open(self.study) as study:
            study.add_trial(record, score=score)
        return round(score.score, 2)

    def until_graded(self, wanted: dict[str, float]) -> None:
        """Wait until the gradebook has these scores, and no others."""
        deadline = time.monotonic() + WITHIN_S
        expected = {user: [score, "FullyGraded"] for user, score in wanted.items()}
        while (found := self.ask("/gradebook")) != expected:
            assert time.monotonic() < deadline, found
            time.sleep(0.2)


@pytest.fixture
def course(tmp_path, study_place):
    course = Course(tmp_path, study_place)
    yield course
    course.tool.kill()
    course.platform.kill()


@pytest.fixture
def browser():
    with sync_playwright() as driver:
        browser = launch(driver)
        yield browser
        browser.close()


def open_link(browser, course, user: str, role: str = "student"):
    """Click the link of the course; return the page that it leads to."""
    page = browser.new_context().new_page()
    page.set_default_timeout(PATIENCE_MS)
    page.goto(f"{course.url}/open/{user}/{role}")
    page.wait_for_url(f"{course.tool_url}/launch")
    return page


def pseudonym_in(page) -> str:
    return page.inner_text(".who strong")


def test_a_course_launches_in_a_browser_and_its_gradebook_receives_the_scores(browser, course):
    page = open_link(browser, course, "u1")
    assert pseudonym_in(page) == "T001"
    assert pseudonym_in(open_link(browser, course, "u2")) == "T002"
    assert page.locator(".who").count() == 1
    assert open_link(browser, course, "teacher", "staff").locator(".who").count() == 0
    first = course.play("T001", 110.0)
    course.until_graded({"u1": first})
    second, better = course.play("T002", 90.0), course.play("T001", 60.0)
    course.until_graded({"u1": better, "u2": second})
    course.play("T001", 300.0)
    page = open_link(browser, course, "u1")
    assert f"{better:.1f} / 100" in page.inner_text("main")
    assert page.locator(".trial").count() == 3
    course.until_graded({"u1": better, "u2": second})
    assert course.tool.stop() == 0


def test_open_edxs_own_launch_is_refused_when_it_is_repeated_or_altered(browser, course):
    context = browser.new_context()
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    posted = []
    page.on("request", lambda request: posted.append(request))
    page.goto(f"{course.url}/open/u1/student")
    page.wait_for_url(f"{course.tool_url}/launch")
    (form,) = (
        dict(parse_qsl(request.post_data))
        for request in posted
        if request.method == "POST" and request.url == f"{course.tool_url}/launch"
    )

    def post(**changes) -> int:
        return context.request.post(f"{course.tool_url}/launch", form={**form, **changes}).status

    assert post() == 400, "the same again"
    place = f"{course.url}/open/u1/student"
    for _step in ("to the tool", "to the platform"):
        place = context.request.get(place, max_redirects=0).headers["location"]
    asked = dict(parse_qsl(urlsplit(place).query))
    assert post(state=asked["state"]) == 400, "of an earlier login"
    answer = context.request.get(f"{course.url}/open/u2/student").text()
    values = dict(re.findall(r'name="(state|id_token)" value="([^"]+)"', answer))
    head, claims, signature = values["id_token"].split(".")
    other = json.loads(base64.urlsafe_b64decode(claims + "=="))
    other["sub"] = "u1"
    forged = base64.urlsafe_b64encode(json.dumps(other).encode()).rstrip(b"=").decode()
    assert post(state=values["state"], id_token=f"{head}.{forged}.{signature}") == 400


def test_kills_of_the_platform_and_of_the_tool_lose_no_grade(browser, course):
    users = [f"u{number}" for number in range(1, 7)]
    trainees = {pseudonym_in(open_link(browser, course, user)): user for user in users}
    expected = {}
    for number, (pseudonym, user) in enumerate(trainees.items()):
        course.platform.kill()
        expected[user] = course.play(pseudonym, 60.0 + 10.0 * number)
        course.tool.kill()
        course.tool.start()
        course.platform.start()
        if number % 2:
            course.until_graded(expected)
    course.until_graded(expected)
    assert [pseudonym_in(open_link(browser, course, user)) for user in users] == list(trainees)
