"""Every menu, page and dialog, opened, closed and opened again in the browser."""

from __future__ import annotations

import pytest

from rastrainer_simulator.net.views.screen import Screen
from Testing.simulator.flow.every_page import every_screen, names_of_pages
from Testing.web.chromium import open_page, show

SHOWN = "document.body.dataset.menu"


@pytest.fixture
def look_at(browser, served):
    """Return a function that shows a screen in the page and returns what its parts hold."""
    page = open_page(browser, served.url, served.code, draws=False)

    def show_and_look(screen):
        show(page, served, screen)
        page.evaluate("frames_(2)")
        return page.inner_html("#menu"), page.is_visible("#menu")

    yield show_and_look
    assert page.problems == []


@pytest.mark.soak
def test_every_page_is_shown_the_same_when_it_is_opened_again(look_at, presenter):
    screens = every_screen(presenter)
    assert names_of_pages() <= screens.keys()
    for name, screen in screens.items():
        first = look_at(screen)
        look_at(Screen())
        assert look_at(screen) == first, name
        assert first[1] == (screen.menu is not None), name
        look_at(Screen())
