"""The page shows the trend of the trainee's scores beside the tasks."""

from __future__ import annotations

import pytest

from rastrainer_simulator.ops.texts.texts import LANGUAGES
from Testing.simulator.flow.scored_journals import task_menu
from Testing.web.chromium import open_page, wait_for

PICTURE = "#menu img"


@pytest.fixture
def page(browser, served):
    size = {"width": 1280, "height": 720}
    page = open_page(browser, served.url, served.code, size=size, draws=False)
    yield page
    assert page.problems == []


@pytest.mark.parametrize(
    "language",
    ["en", *(pytest.param(tag, marks=pytest.mark.soak) for tag in LANGUAGES if tag != "en")],
)
def test_the_plot_stands_beside_the_tasks_and_every_score_is_its_text(
    page, served, loop, outside, language
):
    served.tell(task_menu(loop, outside.services, language=language))
    page.wait_for_selector(PICTURE)
    wait_for(page, f"document.querySelector('{PICTURE}').naturalWidth > 0")
    plot, tasks = page.locator(PICTURE), page.locator("#menu ul")
    assert "38, 52, 47, 67, 71, 69, 88" in plot.get_attribute("alt")
    place, beside = plot.bounding_box(), tasks.bounding_box()
    assert place["width"] > 200
    assert place["x"] + place["width"] <= beside["x"]
