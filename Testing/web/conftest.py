from __future__ import annotations

import asyncio
from asyncio.events import _set_running_loop as set_running_loop

import pytest
from playwright.sync_api import sync_playwright

from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.texts.texts import LANGUAGES
from Testing.end_to_end.lab import PATIENT
from Testing.simulator.conftest import setup  # noqa: F401
from Testing.simulator.flow.conftest import outside, presenter, put_back, shared  # noqa: F401
from Testing.simulator.flow.every_page import LONGEST, longest_of, screens_in
from Testing.simulator.net.views.served import ServedViews
from Testing.web.chromium import launch


@pytest.fixture(scope="session")
def _started():
    """A browser for all modules, as a start takes as long as a short test, and its event loop."""
    with sync_playwright() as driver:
        loop, browser = asyncio.get_running_loop(), launch(driver)
        yield browser, loop
        set_running_loop(loop)
        browser.close()


@pytest.fixture(scope="module")
def browser(_started):
    """The browser. Its event loop counts as running only here: other tests run their own."""
    browser, loop = _started
    set_running_loop(loop)
    yield browser
    for context in browser.contexts:
        context.close()
    set_running_loop(None)


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


_made: dict[str, dict[str, Screen]] = {}


@pytest.fixture
def screens(loop, outside):  # noqa: F811
    """Returns a function that returns all pages in a language, or in their longest, by name."""

    def screens_of(language):
        if language == LONGEST:
            return longest_of([screens_of(tag) for tag in LANGUAGES])
        if language not in _made:
            presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
            _made[language] = screens_in(presenter, language)
            presenter.close()
        return _made[language]

    return screens_of
