"""The page shows the trend of the trainee's scores beside the tasks."""

from __future__ import annotations

import pytest

from Testing.simulator.conftest import setup  # noqa: F401
from Testing.simulator.flow.conftest import loop, outside, shared  # noqa: F401
from Testing.simulator.flow.scored_journals import task_menu
from Testing.simulator.net.views.served import ServedViews
from Testing.web.chromium import open_page, wait_for

PICTURE = "#menu img"


@pytest.fixture
def page(browser, loop, loop_thread):  # noqa: F811
    served = ServedViews(loop_thread, loop)
    page = open_page(browser, served.url, served.code, size={"width": 1280, "height": 720})
    page.served = served
    yield page
    assert page.problems == []
    served.close()


@pytest.mark.parametrize("language", ["en", pytest.param("de", marks=pytest.mark.soak)])
def test_the_plot_stands_beside_the_tasks_and_every_score_is_its_text(
    page,
    loop,  # noqa: F811
    outside,  # noqa: F811
    language,
    tmp_path,
):
    page.served.tell(task_menu(loop, outside.services, language=language))
    page.wait_for_selector(PICTURE)
    wait_for(page, f"document.querySelector('{PICTURE}').naturalWidth > 0")
    plot, tasks = page.locator(PICTURE), page.locator("#menu ul")
    assert "38, 52, 47, 67, 71, 69, 88" in plot.get_attribute("alt")
    place, beside = plot.bounding_box(), tasks.bounding_box()
    assert place["width"] > 200
    assert place["x"] + place["width"] <= beside["x"]
    page.screenshot(path=tmp_path / "trend.png")
