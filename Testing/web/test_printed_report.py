"""A report on paper, whose page breaks leave no page half empty, and on a phone."""

import math
import re

import pytest

from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.report.report import report_html
from Testing.domain.study.played_study import STUDIES
from Testing.simulator.report.test_decisions_in_report import studied
from Testing.simulator.report.test_report import cohort
from Testing.simulator.report.test_tables_have_n import with_intervals
from Testing.simulator.report.without_charts import without_charts
from Testing.simulator.statistics.test_variation import drawn
from Testing.web.chromium import PATIENCE_MS

WIDTH, HEIGHT = 180, 263
"""The printable area of a page, mm; see `@page` in the report's style."""
PX_PER_MM = 96 / 25.4
STUDY = {
    "published": lambda: read_study_data(STUDIES / "published.csv"),
    "many tasks": lambda: cohort(30, tasks=20),
    "every section": lambda: with_intervals(drawn()),
    "four trainees": lambda: with_intervals(drawn(trainees=4)),
    "decisions": studied,
}
LONGER = [pytest.param(name, marks=pytest.mark.soak) for name in list(STUDY)[1:]]


@pytest.mark.parametrize("name", ["published", *LONGER])
def test_a_printed_report_has_hardly_more_pages_than_its_content_fills(browser, name):
    page = browser.new_page(viewport={"width": round(WIDTH * PX_PER_MM), "height": 800})
    page.set_default_timeout(PATIENCE_MS)
    page.set_content(report_html(STUDY[name](), "today"))
    page.emulate_media(media="print")
    filled = page.evaluate("document.body.offsetHeight") / PX_PER_MM / HEIGHT
    pdf = page.pdf(prefer_css_page_size=True, print_background=True)
    page.close()
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    # Page breaks leave less than one page empty in all.
    assert filled <= pages <= math.ceil(filled) + 1


def test_a_phone_scrolls_wide_tables_in_their_section_and_not_the_whole_report(browser):
    page = browser.new_page(viewport={"width": 390, "height": 844})
    page.set_default_timeout(PATIENCE_MS)
    with without_charts():
        page.set_content(report_html(STUDY["four trainees"](), "today"))
    width, widest = page.evaluate("""[document.documentElement.scrollWidth,
      Math.max(...[...document.querySelectorAll("table")].map((table) => table.offsetWidth))]""")
    page.close()
    assert width == 390
    assert widest > 390
