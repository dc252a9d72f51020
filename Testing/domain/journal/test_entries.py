"""Every kind of entry is documented with its keys, and is read as it was written."""

import re
from pathlib import Path

import pytest

from rastrainer.journal.entries import KINDS, Line, PhaseChange, read_line
from rastrainer.json_records import record_fields
from rastrainer.protocol import Phase, Proximity
from Testing.journal_lines import at, header, phase, proximity, sample, touch

PAGE = Path(__file__).parents[3] / "docs" / "trial-journal.md"
ROW = re.compile(r"^\| `([a-z]+)` \| [^|]* \|(.*)\|$", re.MULTILINE)
TEXT = PAGE.read_text(encoding="utf-8")
ROWS = dict(ROW.findall(TEXT.partition("## Kinds")[2].partition("### ")[0]))


def test_the_page_has_a_row_for_each_kind_and_no_other():
    assert set(ROWS) == set(KINDS)


@pytest.mark.parametrize("kind", KINDS)
def test_the_row_of_a_kind_names_its_keys(kind):
    # The states of a phase are explained below the table, with those of a procedure.
    where = TEXT if issubclass(KINDS[kind], PhaseChange) else ROWS[kind]
    keys = {each.key for each in record_fields(KINDS[kind])} - {"seed" if kind == "header" else ""}
    assert [key for key in sorted(keys) if f"`{key}`" not in where] == []


@pytest.mark.parametrize(
    "entry",
    [
        header(),
        sample(feed_mm=1.5),
        touch("1", measured_mm=(3.0, 2.0, 1.0)),
        phase(Phase.PAUSED, "2"),
        proximity(Proximity.CONTACT, Proximity.FREE, 2.5),
    ],
    ids=lambda entry: entry.kind,
)
def test_an_entry_is_read_as_it_was_written(entry):
    line = at(1.25, entry)
    assert read_line(line.to_json()) == line
    assert isinstance(line, Line)
