"""`rastrainer calibrate`: the virtual hand next to measurements of people."""

import json
from dataclasses import replace

import pytest

from rastrainer_simulator.cli import calibrate
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.virtual.calibration import PUBLISHED, calibrated


@pytest.fixture(scope="module")
def found():
    return calibrated(load_setup(None), repeats=2)


def test_the_hand_is_as_people_are_in_what_was_fitted_and_in_what_was_held_out(
    found, monkeypatch, capsys
):
    monkeypatch.setattr(calibrate, "calibrated", lambda _setup, _repeats: found)
    assert main(["calibrate"]) == 0
    *lines, _ = capsys.readouterr().out.partition("Published in:")[0].splitlines()[2:]
    assert [line.rpartition(" ")[2] for line in lines] == ["yes"] * len(PUBLISHED)
    assert 3 <= sum("held out" in line for line in lines) < len(lines)


def test_a_hand_outside_a_published_range_fails_the_command(found, monkeypatch, capsys):
    slow = [replace(one, simulated=0.5) if one.name == "reaction time" else one for one in found]
    monkeypatch.setattr(calibrate, "calibrated", lambda _setup, _repeats: slow)
    assert main(["calibrate", "--json"]) == 1
    printed = json.loads(capsys.readouterr().out)
    assert printed["outside"] == ["reaction time"]
    assert {one["source"] for one in printed["quantities"]} == {one.source for one in PUBLISHED}
