"""Every menu, page and dialog, opened, closed and opened again in the browser."""

from __future__ import annotations

import pytest

from rastrainer_simulator.net.views.screen import Screen
from Testing.simulator.flow.every_page import every_screen, names_of_pages
from Testing.web.chromium import open_page

SHOWN = "document.body.dataset.menu"


@pytest.fixture
def show(browser, served):
    """Return a function that shows a screen in the page and returns what its parts hold."""
    page = open_page(browser, served.url, served.code, draws=False)

    def show(screen):
        served.tell(screen)
        name = "" if screen.menu is None else screen.menu.name
        page.wait_for_selector(f"body[data-menu='{name}']", state="attached")
        page.evaluate("frames_(2)")
        return page.inner_html("#menu"), page.is_visible("#menu")

    yield show
    assert page.problems == []


@pytest.mark.soak
def test_every_page_is_shown_the_same_when_it_is_opened_again(show, presenter):
    screens = every_screen(presenter)
    assert names_of_pages() <= screens.keys()
    for name, screen in screens.items():
        first = show(screen)
        show(Screen())
        assert show(screen) == first, name
        assert first[1] == (screen.menu is not None), name
        show(Screen())
