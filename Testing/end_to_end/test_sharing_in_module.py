"""A button saves a scenario for others, without face and names, or copies it with a plan."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.library import unpack, user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import Role, setPoints, worldPoints
from Testing.end_to_end.module.story import Story, unfold
from Testing.simulator.authoring.heads import egg
from Testing.simulator.authoring.test_export import written
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)


@pytest.fixture(autouse=True)
def users_own_scenario(host, tmp_path):
    """The module with a scenario in the library, and a program of the simulator."""
    user_library().mkdir(parents=True)
    written(user_library() / "ball", np.argsort(-egg().vertices[:, 2])[:300:20])
    Story(host, tmp_path).choose_own_program()
    host.choose("scenarioComboBox", "A ball")
    unfold(host, "shareGroupBox")


@pytest.mark.soak
def test_a_scenario_is_saved_without_face_and_names_unless_they_are_to_be_kept(host, tmp_path):
    host.answer("Save the scenario", tmp_path / "out.zip")
    host.answer("Is the face gone?", "No")
    host.press("exportScenarioButton")
    assert not (tmp_path / "out.zip").exists()
    host.answer("Save the scenario", tmp_path / "out.zip")
    host.answer("Is the face gone?", "Yes")
    host.press("exportScenarioButton")
    (_first, question) = host.messages
    assert question.text == "The picture shows the head before (above) and after. Is the face gone?"
    text = host.text("scenarioText")
    assert "out.zip was written. Removed: the face, the skull, its title, its name" in text
    given = load_scenario(unpack(tmp_path / "out.zip", tmp_path / "library"))
    assert given.title in text
    assert given.title.startswith("Head ")
    assert given.skull is None
    assert read_head_mesh(given.head).vertices[:, 1].max() < egg().vertices[:, 1].max() - 3.0
    host.check("removeFaceCheckBox", False)
    host.check("removeNamesCheckBox", False)
    host.answer("Save the scenario", tmp_path / "whole.zip")
    host.press("exportScenarioButton")
    assert "Nothing was removed." in host.text("scenarioText")
    assert load_scenario(unpack(tmp_path / "whole.zip", tmp_path / "whole")).title == "A ball"


@pytest.mark.soak
def test_a_plan_is_saved_in_a_copy_of_the_scenario_which_is_selected_and_shown(host):
    line = host.scene.AddNewNodeByClass("vtkMRMLMarkupsLineNode", "Other way")
    setPoints(line, ("Entry", "Target"), np.array([[10.0, 20.0, 97.0], [15.0, 10.0, 30.0]]))
    unfold(host, "planCollapsibleButton")
    host.choose("planComboBox", line)
    host.press("keepPlanButton")
    assert "title" in host.messages[-1].text
    host.type("planTitleLineEdit", "A ball, planned anew")
    host.press("keepPlanButton")
    assert len(host.messages) == 1
    assert host.find("scenarioComboBox").currentText == "A ball, planned anew"
    kept = load_scenario(user_library() / "a-ball-planned-anew")
    assert kept.trajectory.name == "Other way"
    assert [target.name for target in kept.targets] == ["Cyst"]
    host.wait_until(lambda: Role.TRAJECTORY.find(host.scene) is not None, "it is shown")
    shown = Role.TRAJECTORY.find(host.scene)
    np.testing.assert_allclose(worldPoints(shown), worldPoints(line))
