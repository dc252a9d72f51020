"""A report on paper, whose page breaks leave no page half empty, and on a phone."""

import importlib.util
import math
import re

import numpy as np
import pytest

from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.report.report import report_html
from Testing.domain.study.played_study import STUDIES
from Testing.simulator.report.test_decisions_in_report import studied
from Testing.simulator.report.test_report import cohort
from Testing.simulator.report.test_tables_have_n import in_two_groups, with_intervals
from Testing.simulator.report.without_charts import without_charts
from Testing.simulator.statistics.test_variation import drawn
from Testing.web.chromium import PATIENCE_MS

WIDTH, HEIGHT = 180, 263
"""Of what may be printed on a page, mm; see `@page` in the report's style."""
PX_PER_MM = 96 / 25.4
STUDY = {
    "published": lambda: read_study_data(STUDIES / "published.csv"),
    "many tasks": lambda: cohort(30, tasks=20),
    "every section": lambda: with_intervals(drawn()),
    "four trainees": lambda: with_intervals(drawn(trainees=4)),
    "decisions": studied,
    "groups": lambda: in_two_groups(cohort(30, tasks=6)),
}
LEAST_FILLED = 0.5
DOTS_PER_MM = 1.0
MARGINS_MM = (16, 18)
"""Top and bottom; see `@page`."""


@pytest.fixture
def printed(browser):
    """Print a report, and return by how many pages its content is filled and the PDF."""

    def print_it(data):
        page = browser.new_page(viewport={"width": round(WIDTH * PX_PER_MM), "height": 800})
        page.set_default_timeout(PATIENCE_MS)
        page.set_content(report_html(data, "today"))
        page.emulate_media(media="print")
        filled = page.evaluate("document.body.offsetHeight") / PX_PER_MM / HEIGHT
        pdf = page.pdf(prefer_css_page_size=True, print_background=True)
        page.close()
        return filled, pdf

    return print_it


@pytest.mark.parametrize("name", ["published", pytest.param("many tasks", marks=pytest.mark.soak)])
def test_a_printed_report_has_hardly_more_pages_than_its_content_fills(printed, name):
    filled, pdf = printed(STUDY[name]())
    pages = len(re.findall(rb"/Type\s*/Page\b", pdf))
    # What page breaks leave empty sums to less than one page.
    assert filled <= pages <= math.ceil(filled) + 1


@pytest.mark.soak
@pytest.mark.parametrize("name", STUDY)
def test_every_printed_page_except_the_last_is_more_than_half_full(printed, name):
    _, pdf = printed(STUDY[name]())
    shares = [filled_share(page) for page in pages_of(pdf)]
    assert len(shares) > 2
    assert min(shares[:-1]) > LEAST_FILLED, [round(share, 2) for share in shares]


def pages_of(pdf):
    """Return the pages as (rows, columns) arrays of gray."""
    assert importlib.util.find_spec("pypdfium2"), "Install what `make soak` needs: pypdfium2."
    import pypdfium2

    document = pypdfium2.PdfDocument(pdf)
    scale = DOTS_PER_MM * 25.4 / 72
    return [page.render(scale=scale, grayscale=True).to_numpy().squeeze() for page in document]


def filled_share(page):
    """Return the part of its printable height down to which a page has more ink than a line."""
    top, bottom = (round(margin * DOTS_PER_MM) for margin in MARGINS_MM)
    inked = np.flatnonzero((page < 250).any(axis=1)[top : len(page) - bottom])
    assert len(inked), "an empty page"
    return (inked[-1] + 1) / (len(page) - top - bottom)


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


@pytest.mark.soak
def test_a_half_empty_page_would_be_detected(browser):
    page = browser.new_page()
    page.set_default_timeout(PATIENCE_MS)
    page.set_content("<style>@page { size: A4; margin: 16mm 15mm 18mm }</style><p>one line</p>")
    pdf = page.pdf(prefer_css_page_size=True)
    page.close()
    assert [filled_share(one) < 0.1 for one in pages_of(pdf)] == [True]
