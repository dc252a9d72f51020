"""A scenario's images are the background of the slice views, read once and in the background."""

from dataclasses import replace

import numpy as np
import pytest
import slicer

from rastrainer.head.volume import VolumeFile, write_nrrd
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.nodes import VOLUME, Role, nodesOfClass
from rastrainer.slicer.scene.scenario_nodes import SceneFileLoader, showImages, showScenario
from Testing.domain.scenario.made_up_scenario import ball_volume
from Testing.slicer.work_at_once import in_turns


class Loading:
    """A loader and its background work, driven as the module's timer does it."""

    def __init__(self, scene):
        self.scene = scene
        self.work = BackgroundWork()
        self.loader = SceneFileLoader(scene, self.work)
        self.shown, self.problems = [], []
        self.loader.shown.connect(self.take)
        self.loader.problemFound.connect(self.problems.append)

    def take(self, node):
        if node.IsA(VOLUME):
            self.shown.append(node)

    def finish(self):
        self.loader.process()
        in_turns(self.work, self.loader.process)

    @property
    def node(self):
        return Role.HEAD_VOLUME.find(self.scene)


@pytest.fixture
def loading(scene):
    return Loading(scene)


@pytest.fixture
def imaged(scenario):
    """The scenario with images of its ball."""
    path = scenario.folder / "volume.nrrd"
    write_nrrd(path, ball_volume().values, ball_volume().ijk_to_ras)
    return replace(scenario, volume=VolumeFile(path, 120.0, 60.0))


def backgrounds(scene):
    nodes = nodesOfClass(scene, "vtkMRMLSliceCompositeNode")
    return [node.GetBackgroundVolumeID() for node in nodes]


def test_the_images_lie_where_the_head_is_with_their_window_in_all_slice_views(
    scene, loading, imaged
):
    showScenario(scene, imaged)
    loading.finish()
    node, images = loading.node, ball_volume()
    assert np.array_equal(slicer.util.arrayFromVolume(node).T, images.values)
    bounds, head = np.zeros(6), np.zeros(6)
    node.GetRASBounds(bounds)
    Role.HEAD_MODEL.find(scene).GetRASBounds(head)
    assert ((bounds - head) * [-1, 1, -1, 1, -1, 1] > 0.0).all()
    display = node.GetDisplayNode()
    assert not display.GetAutoWindowLevel()
    assert (display.GetWindow(), display.GetLevel()) == (120.0, 60.0)
    assert backgrounds(scene) == [node.GetID()] * 3
    assert loading.shown == [node]
    assert loading.problems == []


def test_displayed_images_are_read_again_only_when_rebuilt_and_a_users_changes_stay(
    scene, loading, imaged, scenario
):
    showScenario(scene, imaged)
    loading.finish()
    loading.node.GetDisplayNode().SetWindowLevel(40.0, 20.0)
    other = scene.AddNewNodeByClass(VOLUME, "Another MRI")
    composite = nodesOfClass(scene, "vtkMRMLSliceCompositeNode")[0]
    composite.SetBackgroundVolumeID(other.GetID())
    showScenario(scene, imaged)
    loading.finish()
    assert loading.shown == [loading.node]
    assert loading.node.GetDisplayNode().GetWindow() == 40.0
    assert backgrounds(scene)[0] == other.GetID()
    showImages(scene)
    assert backgrounds(scene) == [loading.node.GetID()] * 3
    # Rebuilt images are read again.
    write_nrrd(imaged.volume.file, ball_volume(60.0).values, ball_volume(60.0).ijk_to_ras)
    showScenario(scene, imaged)
    loading.finish()
    assert np.array_equal(slicer.util.arrayFromVolume(loading.node).T, ball_volume(60.0).values)
    # If two scenarios are shown at once, the last stays, even without images.
    showScenario(scene, replace(imaged, name="other"))
    loading.loader.process()
    showScenario(scene, scenario)
    loading.finish()
    assert loading.node is None
    assert not any(backgrounds(scene))


def test_unusable_images_are_reported_and_the_head_is_shown(scene, loading, imaged):
    imaged.volume.file.write_bytes(b"no image")
    showScenario(scene, imaged)
    loading.finish()
    assert loading.node is None
    (sentence,) = loading.problems
    assert sentence.startswith("There are no images in the slice views: ")
    assert "volume.nrrd" in sentence
    assert Role.HEAD_MODEL.find(scene) is not None


def test_a_node_deleted_while_it_is_read_stays_deleted(scene, loading, imaged):
    showScenario(scene, imaged)
    loading.loader.process()
    scene.RemoveNode(loading.node)
    loading.finish()
    assert loading.node is None
    assert loading.problems == loading.shown == []
