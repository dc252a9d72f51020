"""Any model or volume of the scene can be the head that is looked at."""

import numpy as np
import pytest
import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.registration_nodes import isApplied
from rastrainer.slicer.scenario_desk import ScenarioDesk
from rastrainer.slicer.scene import Role, findNode
from rastrainer_simulator.assets import asset_path


class Shelf:
    def __init__(self, scenario):
        self._scenario = scenario

    def scenarios(self):
        return (self._scenario,)

    def find(self, _name):
        return self._scenario


@pytest.fixture
def desk(scene, scenario):
    return ScenarioDesk(scene, Shelf(scenario), asset_path("robots", "iiwa7"))


def volume(scene, values, spacing):
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "MRI")
    slicer.util.updateVolumeFromArray(node, values)
    node.SetSpacing(spacing, spacing, spacing)
    return node


def test_showing_a_scenario_places_the_robots_world_as_planned(scene, desk):
    desk.show("ball", "task-1")
    transform = findNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
    assert isApplied(transform)
    assert not desk.isRobotShown
    desk.setRobotShown(True)
    assert desk.isRobotShown
    desk.setRobotShown(False)
    assert not desk.isRobotShown


def test_the_skin_of_a_volume_becomes_the_head(scene, desk):
    desk.show("ball", "task-1")
    former = findNode(scene, "vtkMRMLModelNode", Role.HEAD_MODEL)
    grid = np.indices((60, 60, 60)) - 30.0
    ball = (np.linalg.norm(grid, axis=0) < 24).astype(np.float32) * 100.0
    steps = []
    model = desk.useHead(volume(scene, ball, 3.0), lambda step, _share: steps.append(step))
    assert findNode(scene, "vtkMRMLModelNode", Role.HEAD_MODEL) is model
    assert model.GetName() == "Head of MRI"
    assert not former.GetDisplayVisibility()
    bounds = np.array(model.GetPolyData().GetBounds())
    np.testing.assert_allclose(bounds[1] - bounds[0], 2 * 24 * 3.0, atol=4.0)
    assert steps[-1] == "Done"


def test_a_volume_without_an_image_is_told(scene, desk):
    with pytest.raises(InputError, match="holds no image"):
        desk.useHead(scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Empty"))
