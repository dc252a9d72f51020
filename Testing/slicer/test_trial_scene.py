"""Lists of points in the scene become a transform that remembers them."""

import numpy as np
import pytest
from slicer.util import arrayFromMarkupsControlPoints

from rastrainer import transforms
from rastrainer.registration.registration import register
from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene import trial_scene
from rastrainer.slicer.scene.nodes import labelsOf, setPoints, worldPoints
from rastrainer.slicer.scene.registration_input import Choices, readPairs
from rastrainer.slicer.scene.trial_scene import placeWorld
from Testing.slicer.scene_bundle import load_bundle


@pytest.fixture
def points():
    return np.random.default_rng(5).normal(0.0, 60.0, (15, 3))


def markups(scene, name, labels, points):
    node = scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", name)
    setPoints(node, labels, points)
    return node


@pytest.fixture
def fixed(scene, points):
    return markups(scene, "Fixed", LABELS, points)


@pytest.fixture
def moving(scene, points):
    head_to_world = transforms.rigid(np.diag([-1.0, -1.0, 1.0]), np.array([500.0, 20.0, 300.0]))
    noise = np.random.default_rng(6).normal(0.0, 0.8, (15, 3))
    touched = transforms.apply(head_to_world, points + noise)
    return markups(scene, "CapturedPoints", LABELS, touched)


def registered(moving, fixed):
    """Return the registration of two lists of the scene."""
    pairs = readPairs(moving, fixed, Choices())
    return register(pairs.moving, pairs.fixed, "rigid", pairs.labels)


def placed(scene, registration, moving, fixed):
    return placeWorld(scene, registration.matrix, registration.kind, moving, fixed)


def test_the_result_is_applied_or_not_and_another_registration_gives_the_same(
    scene, moving, fixed, points
):
    registration = registered(moving, fixed)
    node = placed(scene, registration, moving, fixed)
    assert trial_scene.isApplied(node)
    residuals = np.linalg.norm(worldPoints(moving) - points, axis=1)
    np.testing.assert_allclose(residuals, registration.residuals_mm, atol=1e-6)
    np.testing.assert_array_equal(registered(moving, fixed).matrix, registration.matrix)
    trial_scene.setApplied(node, False)
    np.testing.assert_allclose(worldPoints(moving), arrayFromMarkupsControlPoints(moving))
    assert placed(scene, registration, moving, fixed) is node
    assert not trial_scene.isApplied(node)
    # Deleted lists cause no trouble.
    scene.RemoveNode(moving)
    assert trial_scene.movingNode(node) is None
    assert not trial_scene.isApplied(node)
    trial_scene.setApplied(node, True)


def test_the_transform_remembers_its_lists_even_in_a_saved_scene(
    headless_scene, moving, fixed, tmp_path
):
    node = placed(headless_scene.scene, registered(moving, fixed), moving, fixed)
    assert trial_scene.movingNode(node) is moving
    headless_scene.save(tmp_path / "trial.mrb")
    load_bundle(headless_scene, tmp_path / "trial.mrb")
    node = headless_scene.scene.GetFirstNodeByName("WorldToHead")
    assert trial_scene.movingNode(node).GetName() == "CapturedPoints"
    assert labelsOf(node.GetNodeReference(trial_scene.FIXED_REFERENCE)) == LABELS
    assert trial_scene.isApplied(node)
