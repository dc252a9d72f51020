"""The page after a launch from a course, in a browser that comes from the platform's page."""

from __future__ import annotations

import uuid
from urllib.parse import urlencode

import numpy as np
import pytest

from rastrainer.study.database.study import Study
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.free_port import free_port
from Testing.simulator.lti.conftest import Lab, key_and_study  # noqa: F401
from Testing.web.chromium import PATIENCE_MS, accessibility_checker, resize
from Testing.web.test_board import CUT_OFF
from Testing.web.test_page_access import SIZES, VIOLATIONS


@pytest.fixture
def lab(loop_thread, tmp_path, key_and_study):  # noqa: F811
    lab = Lab(loop_thread, tmp_path, *key_and_study, port=free_port())
    yield lab
    lab.close()


def open_link(browser, lab, locale: str):
    context = browser.new_context(locale=locale)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    begun = {
        "iss": lab.platform.address,
        "login_hint": "user-1",
        "target_link_uri": f"{lab.address}/launch",
    }
    page.goto(f"{lab.address}/login?{urlencode(begun)}")
    page.wait_for_selector("h1")
    page.wait_for_load_state()
    return page


def play(lab, tre_mm: float) -> None:
    record = make_record(trialId=str(uuid.uuid4()), trainee="T001")
    with Study.open(lab.study) as study:
        study.add_trial(record, score=gentle_score(record["completionTimeS"], tre_mm))
        study.set_truth(record["trialId"], tre_mm, np.eye(4).ravel().tolist())


@pytest.mark.parametrize(
    "locale",
    [
        "de-DE",
        *(
            pytest.param(tag, marks=pytest.mark.soak)
            for tag in ("en-US", "fr-CA", "es-MX", "zh-CN")
        ),
    ],
)
def test_the_launch_page_breaks_no_accessibility_rule_and_fits_every_size(browser, lab, locale):
    empty = open_link(browser, lab, locale)
    assert empty.locator(".trial").count() == 0
    empty.context.close()
    for number in range(12):
        play(lab, 0.2 * number)
    page = open_link(browser, lab, locale)
    written = "zh-Hans" if locale == "zh-CN" else locale[:2]
    assert page.locator("html").get_attribute("lang") == written
    assert page.inner_text(".who strong") == "T001"
    assert page.locator(".trial").count() == 12
    page.evaluate(accessibility_checker())
    found = []
    for size, pixels in SIZES.items():
        resize(page, *pixels)
        wrong = page.evaluate(CUT_OFF)
        wrong += page.evaluate(VIOLATIONS) if size in ("narrowest", "laptop") else []
        found += [f"{size}: {each}" for each in wrong]
    page.context.close()
    assert found == []
