"""`rastrainer calibrate`: the virtual hand next to measurements of people."""

import json
from dataclasses import replace

import pytest

from rastrainer_simulator.cli import cohort
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.virtual.calibration import PUBLISHED, calibrated


@pytest.mark.soak
def test_the_hand_is_as_people_are_in_what_was_fitted_and_in_what_was_held_out():
    found = calibrated(load_setup(None), repeats=2)
    assert [one.name for one in found if not one.holds] == []
    assert 3 <= sum(not one.fitted for one in found) < len(found)


def test_the_command_lists_each_quantity_and_fails_if_one_is_outside_its_range(monkeypatch, capsys):
    found = [replace(one, simulated=one.least) for one in PUBLISHED]
    monkeypatch.setattr(cohort, "calibrated", lambda _setup, _repeats: found)
    assert main(["calibrate"]) == 0
    *lines, _ = capsys.readouterr().out.partition("Published in:")[0].splitlines()[2:]
    assert [line.rpartition(" ")[2] for line in lines] == ["yes"] * len(PUBLISHED)
    found[0] = replace(found[0], simulated=0.5 * found[0].least)
    assert main(["calibrate", "--json"]) == 1
    printed = json.loads(capsys.readouterr().out)
    assert printed["outside"] == [PUBLISHED[0].name]
    assert {one["source"] for one in printed["quantities"]} == {one.source for one in PUBLISHED}
