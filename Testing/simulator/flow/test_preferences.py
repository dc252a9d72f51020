"""Preferences: each one of its options, saved, applied, and refused where they are not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.flow.session.preferences import (
    OF_THE_SIMULATION,
    OPTIONS,
    Preferences,
    read_preferences,
    write_preferences,
)


def test_each_option_is_saved_and_read(tmp_path):
    path = tmp_path / "preferences.json"
    for name, options in {**OPTIONS, "expert": ("E01",)}.items():
        for option in options:
            preferences = replace(Preferences(), **{name: option})
            write_preferences(path, preferences)
            assert read_preferences(path) == preferences


def test_only_preferences_that_affect_the_simulation_change_it():
    for name, options in OPTIONS.items():
        other = next(each for each in options if each != getattr(Preferences(), name))
        changed = replace(Preferences(), **{name: other}).applied_to(SimulationSettings())
        assert (changed != SimulationSettings()) is (name in OF_THE_SIMULATION)


def test_an_invalid_option_is_refused_with_what_would_be_valid(tmp_path):
    path = tmp_path / "preferences.json"
    path.write_text('{"volume": 55}')
    with pytest.raises(InputError, match="volume must be one of 0, 10, "):
        read_preferences(path)
