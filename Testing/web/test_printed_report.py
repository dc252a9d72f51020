"""A report on paper: page breaks leave no page half empty."""

import math
import re

import pytest

from rastrainer.report.report import report_html
from rastrainer.study.study_data import read_study_data
from Testing.domain.report.test_report import cohort
from Testing.domain.study.played_study import STUDIES

WIDTH, HEIGHT = 180, 263
"""Of what may be printed on a page, mm; see `@page` in the report's style."""
PX_PER_MM = 96 / 25.4
STUDY = {
    "published": lambda: read_study_data(STUDIES / "published.csv"),
    "many tasks": lambda: cohort(30, tasks=20),
}


@pytest.mark.parametrize("name", STUDY)
def test_a_printed_report_has_hardly_more_pages_than_its_content_fills(browser, name):
    page = browser.new_page(viewport={"width": round(WIDTH * PX_PER_MM), "height": 800})
    page.set_content(report_html(STUDY[name](), "today"))
    page.emulate_media(media="print")
    filled = page.evaluate("document.body.offsetHeight") / PX_PER_MM / HEIGHT
    printed = page.pdf(prefer_css_page_size=True, print_background=True)
    pages = len(re.findall(rb"/Type\s*/Page\b", printed))
    page.close()
    # What page breaks leave empty adds up to less than one page.
    assert filled <= pages <= math.ceil(filled) + 1
