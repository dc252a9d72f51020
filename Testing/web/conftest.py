from __future__ import annotations

import pytest
from playwright.sync_api import sync_playwright

from rastrainer_simulator.loop.control_loop import ControlLoop
from Testing.end_to_end.lab import PATIENT
from Testing.simulator.conftest import setup  # noqa: F401
from Testing.simulator.flow.conftest import outside, presenter, put_back, shared  # noqa: F401
from Testing.simulator.net.views.served import ServedViews
from Testing.web.chromium import launch


@pytest.fixture(scope="module")
def driver():
    """Starts browsers; ends with its module, as other tests need the event loop."""
    with sync_playwright() as driver:
        yield driver


@pytest.fixture(scope="module")
def browser(driver):
    browser = launch(driver)
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def loop(shared, tmp_path_factory):  # noqa: F811
    """A control loop in this process that leaves the processors to the browser."""
    put_back(shared)
    with ControlLoop(shared, tmp_path_factory.mktemp("loop") / "records") as loop:
        yield loop


@pytest.fixture(scope="module")
def served(loop, loop_thread):
    """Views of that loop, served to pages that show what a test sends them."""
    served = ServedViews(loop_thread, loop, **PATIENT)
    yield served
    served.close()
