"""The shelf finds scenarios by name as they are on disk now."""

import os
import shutil
from dataclasses import replace

import pytest

from rastrainer.errors import InputError
from rastrainer.scenario_writer import new_folder, write_scenario
from rastrainer.slicer.scenario_shelf import ScenarioShelf
from Testing.domain.made_up_scenario import ball_head, made_up_scenario


def build(folder, title):
    """Build the ball in place of what is there, a second later by the file's time."""
    later = (folder / "scenario.json").stat().st_mtime + 1.0 if folder.exists() else 1.0
    shutil.rmtree(folder, ignore_errors=True)
    with new_folder(folder) as made:
        write_scenario(made, replace(made_up_scenario(), title=title), ball_head())
    os.utime(folder / "scenario.json", (later, later))


def test_a_scenario_that_was_built_anew_is_read_anew(tmp_path):
    build(tmp_path / "ball", "First")
    shelf = ScenarioShelf.below(tmp_path)
    first = shelf.find("ball")
    assert shelf.find("ball") is first
    build(tmp_path / "ball", "Second")
    assert shelf.find("ball").title == "Second"


def test_a_scenario_that_was_removed_is_told(tmp_path):
    build(tmp_path / "ball", "First")
    shelf = ScenarioShelf.below(tmp_path)
    shelf.find("ball")
    shutil.rmtree(tmp_path / "ball")
    with pytest.raises(InputError, match="is not here"):
        shelf.find("ball")
