"""The cache finds scenarios by name as they are on disk now."""

import os
import shutil
from dataclasses import replace

import pytest

from rastrainer.errors import InputError
from rastrainer.scenario.library import user_library
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer.sections.scenario_files import ScenarioCache
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario


def build(folder, title):
    """Put the ball into the folder; its file is a second newer."""
    later = (folder / "scenario.json").stat().st_mtime + 1.0 if folder.exists() else 1.0
    shutil.rmtree(folder, ignore_errors=True)
    with new_folder(folder) as made:
        write_scenario(made, replace(made_up_scenario(), title=title), ball_head())
    os.utime(folder / "scenario.json", (later, later))


def test_a_rebuilt_scenario_is_read_again_and_a_removed_one_reported(tmp_path):
    build(tmp_path / "ball", "First")
    cache = ScenarioCache(tmp_path)
    first = cache.find("ball")
    assert cache.find("ball") is first
    build(tmp_path / "ball", "Second")
    assert cache.find("ball").title == "Second"
    shutil.rmtree(tmp_path / "ball")
    with pytest.raises(InputError, match="is not here"):
        cache.find("ball")


def test_for_a_title_in_use_a_free_one_is_suggested_or_the_users_own_scenario_moved_away(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("HOME", str(tmp_path))
    mine = user_library()
    build(mine / "ball", "Ball")
    cache = ScenarioCache(mine)
    with pytest.raises(InputError, match=r"Ball 2, or first move the folder .*ball elsewhere"):
        cache.newName("Ball")
    (mine / "ball").rename(tmp_path / "elsewhere")
    assert cache.newName("Ball") == "ball"
