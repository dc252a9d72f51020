"""Every kind of entry is read as it was written."""

import pytest

from rastrainer.commands import CommandName
from rastrainer.journal.entries import CommandDone, Line, read_line
from rastrainer.protocol import Phase, Proximity
from Testing.journal_lines import at, header, phase, proximity, sample, touch


@pytest.mark.parametrize(
    "entry",
    [
        header(),
        sample(feed_mm=1.5),
        touch("1", measured_mm=(3.0, 2.0, 1.0)),
        phase(Phase.PAUSED, "2"),
        proximity(Proximity.CONTACT, Proximity.FREE, 2.5),
        CommandDone(CommandName.GET_TRIAL, {}, "3D Slicer"),
    ],
    ids=lambda entry: entry.kind,
)
def test_an_entry_is_read_as_it_was_written(entry):
    line = at(1.25, entry)
    assert read_line(line.to_json()) == line
    assert isinstance(line, Line)
