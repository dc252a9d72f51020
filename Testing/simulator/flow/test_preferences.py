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


@pytest.mark.parametrize("name", OPTIONS)
def test_each_option_is_saved_and_read(tmp_path, name):
    path = tmp_path / "preferences.json"
    for option in OPTIONS[name]:
        preferences = replace(Preferences(), **{name: option})
        write_preferences(path, preferences)
        assert read_preferences(path) == preferences


def test_the_experts_id_is_read_and_kept(tmp_path):
    path = tmp_path / "preferences.json"
    path.write_text('{"expert": "E01", "ghost": "expert"}')
    preferences = read_preferences(path)
    assert (preferences.expert, preferences.ghost) == ("E01", "expert")
    write_preferences(path, replace(preferences, language="de"))
    assert read_preferences(path).expert == "E01"


def test_the_defaults_leave_the_simulation_unchanged():
    assert Preferences().applied_to(SimulationSettings()) == SimulationSettings()


@pytest.mark.parametrize("name", OPTIONS)
def test_only_preferences_that_affect_the_simulation_change_it(name):
    other = next(each for each in OPTIONS[name] if each != getattr(Preferences(), name))
    changed = replace(Preferences(), **{name: other}).applied_to(SimulationSettings())
    assert (changed != SimulationSettings()) is (name in OF_THE_SIMULATION)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("7", "must be a JSON object"),
        ('{"color": "red"}', 'there is no "color"; use language, volume, muted'),
        ('{"self_alignment": true}', 'there is no "self_alignment"; use .*, selfAlignment, view'),
        ('{"volume": 55}', "volume must be one of 0, 10, "),
        ('{"volume": true}', "volume must be one of 0, 10, "),
        ('{"muted": 1}', "muted must be one of false, true"),
        ('{"language": ["de"]}', 'language must be one of "en", "de", "fr", "es", "zh-Hans"'),
        ("{", "is not JSON"),
        ('{"expert": 7}', "expert must be printable text of 0 to 64 characters"),
    ],
)
def test_an_invalid_option_is_refused_with_a_message(tmp_path, content, sentence):
    path = tmp_path / "preferences.json"
    path.write_text(content)
    with pytest.raises(InputError, match=sentence):
        read_preferences(path)
