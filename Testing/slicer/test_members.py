"""The members that the host allows are those that were measured."""

import json
import os
from pathlib import Path

from Testing.slicer.host.members import FACTS, MODULES, members_of, module_of
from Testing.slicer.host.offered import OFFERED
from Testing.slicer.host.reduce_members import TARGET, reduced, text_of


def test_the_table_holds_what_the_host_offers():
    for module in MODULES:
        assert list(FACTS[module]) == list(OFFERED[module])


def test_every_widget_has_what_a_widget_has():
    button = members_of("QPushButton")
    assert {"enabled", "toolTip", "visible", "text"} <= button.properties
    assert "clicked(bool)" in button.signals
    assert {"setLayout", "click"} <= button.methods
    assert module_of("QNoSuchWidget") is None


def test_the_table_is_the_measurement_where_that_is_at_hand():
    full = os.environ.get("RASTRAINER_SLICER_API")
    measured = json.loads(Path(full).read_text()) if full else FACTS
    assert TARGET.read_text() == text_of(reduced(measured))
