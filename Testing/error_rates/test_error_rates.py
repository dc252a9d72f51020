"""The statistics of a report err as seldom as docs/error-rates.md says, and find what it says."""

import re

import pytest

from Testing.error_rates.page import PAGE, SETS, TABLES, printed, with_table

FEW = {"several groups": 40, "target errors": 50, "learning": 100}
"""Fewer data sets of what is costly."""


@pytest.mark.parametrize("name", TABLES)
def test_what_is_asked_holds_in_a_few_seeded_data_sets(name):
    _, simulate = TABLES[name]
    found = simulate(FEW.get(name, 150))
    assert any(one.at_most is not None or one.at_least is not None for one in found)
    failing = [one for one in found if not one.holds(standard_errors=3.3)]
    assert failing == []


def test_the_page_has_every_table_and_all_that_is_asked_holds_in_it():
    text = PAGE.read_text(encoding="utf-8")
    for name, (header, _) in TABLES.items():
        head, _, *lines = printed(name, text).splitlines()
        assert [cell.strip() for cell in head.strip("|").split("|")] == [
            *header[:2],
            "required",
            *header[2:],
        ]
        for line in lines:
            share, asked = (cell.strip() for cell in line.strip("|").split("|")[1:3])
            told, limit = (float(re.sub("[^0-9.]", "", text) or 0) for text in (share, asked))
            assert asked == "–" or (told <= limit if asked.startswith("≤") else told >= limit)


def test_a_table_is_put_in_its_place_and_nothing_else_is_touched():
    text = "a\n<!-- groups -->\n<!-- end -->\nb\n<!-- throughput -->\nold\n<!-- end -->\nc\n"
    once = with_table("groups", text, "| new |")
    assert once == text.replace("<!-- groups -->\n", "<!-- groups -->\n| new |\n")
    assert with_table("groups", once, "| new |") == once
    with pytest.raises(ValueError, match="one place for the table 'studies'"):
        with_table("studies", text, "| new |")


@pytest.mark.soak
@pytest.mark.parametrize("name", TABLES)
def test_everything_asked_holds_and_the_page_tells_the_shares(name):
    _, simulate = TABLES[name]
    found = simulate(SETS)
    assert [one for one in found if not one.holds()] == []
    lines = printed(name, PAGE.read_text(encoding="utf-8")).splitlines()[2:]
    assert len(lines) == len(found)
    for one, line in zip(found, lines, strict=True):
        case, share, asked, *_ = [cell.strip() for cell in line.strip("|").split("|")]
        assert (case, asked) == (one.cells()[0], one.cells()[2])
        # Other versions of numpy and scipy may round a p-value at the level otherwise.
        told = one.cells()[1].removesuffix(" %")
        assert float(share.removesuffix(" %")) == pytest.approx(float(told), abs=0.3)
