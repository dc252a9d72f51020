"""A scenario is saved for others by a button: face and names go, and what went is told."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import load_scenario
from rastrainer.scenario_library import user_library
from rastrainer.scenario_package import unpack
from Testing.end_to_end.module.story import Story
from Testing.simulator.scenarios.heads import egg
from Testing.simulator.scenarios.test_export import written
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)


@pytest.fixture(autouse=True)
def scenario_of_ones_own(host, tmp_path):
    """The module with a scenario in the library, and a program of the simulator."""
    user_library().mkdir(parents=True)
    written(user_library() / "ball", np.argsort(-egg().vertices[:, 2])[:300:20])
    Story(host, tmp_path).choose_own_program()
    host.choose("scenarioComboBox", "A ball")
    host.find("shareGroupBox").collapsed = False
    host.process_events()


def test_it_is_saved_without_face_and_names_and_that_is_told(host, tmp_path):
    host.answer("Save the scenario", tmp_path / "out.zip")
    host.press("exportScenarioButton")
    assert host.messages == []
    told = host.text("scenarioText")
    assert "out.zip is written. Taken off: the face, the skull, its title, its name" in told
    given = read_scenario(tmp_path)
    assert given.title in told
    assert given.title.startswith("Head ")
    assert given.skull_mesh is None
    assert read_head_mesh(given.head_mesh).vertices[:, 1].max() < egg().vertices[:, 1].max() - 3.0


def test_face_and_names_stay_where_that_is_chosen(host, tmp_path):
    host.check("removeFaceCheckBox", False)
    host.check("removeNamesCheckBox", False)
    host.answer("Save the scenario", tmp_path / "out.zip")
    host.press("exportScenarioButton")
    assert "Nothing was taken off." in host.text("scenarioText")
    assert read_scenario(tmp_path).title == "A ball"


def read_scenario(folder):
    """Return what the file holds."""
    return load_scenario(unpack(folder / "out.zip", folder / "library"))
