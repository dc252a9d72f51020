"""The pages with which the views are tested are all that there are."""

from __future__ import annotations

from Testing.simulator.flow.every_page import names_of_pages, screens_in


def test_every_page_is_among_those_that_the_views_are_tested_with(presenter):
    assert names_of_pages() <= screens_in(presenter, "en").keys()
