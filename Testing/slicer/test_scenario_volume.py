"""A scenario's images are the background of the slice views, read once and in the background."""

import threading
from dataclasses import replace

import numpy as np
import pytest
import slicer

from rastrainer.head.mesh import write_head_mesh
from rastrainer.head.volume import VolumeFile, write_nrrd
from rastrainer.scenario.scenario import SkullFile, SkullKind
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene import scenario_nodes
from rastrainer.slicer.scene.nodes import VOLUME, Role, nodesOfClass
from rastrainer.slicer.scene.scenario_nodes import SceneFileLoader, showImages, showScenario
from rastrainer_headless.scene import HeadlessScene
from Testing.domain.scenario.made_up_scenario import ball_head, ball_volume
from Testing.slicer.scene_bundle import load_bundle
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


def composites(scene):
    return nodesOfClass(scene, "vtkMRMLSliceCompositeNode")


def backgrounds(scene):
    return [node.GetBackgroundVolumeID() for node in composites(scene)]


def test_the_images_lie_where_the_head_is_with_their_window_in_all_slice_views(
    scene, loading, imaged
):
    showScenario(scene, imaged)
    loading.finish()
    node, images = loading.node, ball_volume()
    assert np.array_equal(slicer.util.arrayFromVolume(node).T, images.values)
    bounds, head = [0.0] * 6, [0.0] * 6
    node.GetRASBounds(bounds)
    Role.HEAD_MODEL.find(scene).GetRASBounds(head)
    assert all(low < other for low, other in zip(bounds[::2], head[::2], strict=True))
    assert all(high > other for high, other in zip(bounds[1::2], head[1::2], strict=True))
    display = node.GetDisplayNode()
    assert not display.GetAutoWindowLevel()
    assert (display.GetWindow(), display.GetLevel()) == (120.0, 60.0)
    assert backgrounds(scene) == [node.GetID()] * 3
    assert loading.shown == [node]
    assert loading.problems == []


def test_meshes_and_images_are_read_beside_the_main_thread_and_shown_one_in_a_turn(
    scene, imaged, monkeypatch
):
    threads = {}

    def watch(name):
        function = getattr(scenario_nodes, name)

        def watched(path):
            threads[path.name] = threading.get_ident()
            return function(path)

        monkeypatch.setattr(scenario_nodes, name, watched)

    for name in ("read_head_mesh", "read_nrrd"):
        watch(name)
    skull = imaged.folder / "skull.ply"
    write_head_mesh(skull, ball_head(80.0))
    showScenario(scene, replace(imaged, skull=SkullFile(skull, SkullKind.BONE)))
    assert threads == {}
    loading, filled = Loading(scene), []
    loading.loader.process()

    def count():
        models = [role.find(scene) for role in (Role.HEAD_MODEL, Role.SKULL)]
        data = [*(model.GetPolyData() for model in models), loading.node.GetImageData()]
        filled.append(sum(each is not None for each in data))

    in_turns(loading.work, count)
    assert threads.keys() == {"head.ply", "skull.ply", "volume.nrrd"}
    assert threading.get_ident() not in threads.values()
    assert {1, 2, 3} <= set(filled)


def test_displayed_images_are_not_read_again_and_a_users_changes_stay(scene, loading, imaged):
    showScenario(scene, imaged)
    loading.finish()
    loading.node.GetDisplayNode().SetWindowLevel(40.0, 20.0)
    other = scene.AddNewNodeByClass(VOLUME, "Another MRI")
    composites(scene)[0].SetBackgroundVolumeID(other.GetID())
    count = scene.GetNumberOfNodes()
    showScenario(scene, imaged)
    loading.finish()
    assert loading.shown == [loading.node]
    assert scene.GetNumberOfNodes() == count
    assert loading.node.GetDisplayNode().GetWindow() == 40.0
    assert backgrounds(scene)[0] == other.GetID()
    showImages(scene)
    assert backgrounds(scene) == [loading.node.GetID()] * 3


def test_rebuilt_images_are_read_again_and_those_of_another_scenario_removed(
    scene, loading, imaged, scenario
):
    showScenario(scene, imaged)
    loading.finish()
    write_nrrd(imaged.volume.file, ball_volume(60.0).values, ball_volume(60.0).ijk_to_ras)
    showScenario(scene, imaged)
    loading.finish()
    assert np.array_equal(slicer.util.arrayFromVolume(loading.node).T, ball_volume(60.0).values)
    assert len(loading.shown) == 2
    showScenario(scene, scenario)
    loading.finish()
    assert loading.node is None
    assert not any(backgrounds(scene))


def test_of_two_scenarios_shown_at_once_the_last_ones_images_are_shown(scene, loading, imaged):
    path = imaged.folder / "other.nrrd"
    write_nrrd(path, ball_volume(60.0).values, ball_volume(60.0).ijk_to_ras)
    showScenario(scene, imaged)
    loading.loader.process()
    showScenario(scene, replace(imaged, name="other", volume=VolumeFile(path, 10.0, 5.0)))
    loading.finish()
    assert np.array_equal(slicer.util.arrayFromVolume(loading.node).T, ball_volume(60.0).values)
    assert len(loading.shown) == 1


@pytest.mark.parametrize("content", [None, b"no image"])
def test_unusable_images_are_reported_and_the_head_is_shown(scene, loading, imaged, content):
    imaged.volume.file.unlink()
    if content is not None:
        imaged.volume.file.write_bytes(content)
    showScenario(scene, imaged)
    loading.finish()
    assert loading.node is None
    (sentence,) = loading.problems
    assert sentence.startswith("There are no images in the slice views: ")
    assert "volume.nrrd" in sentence
    assert Role.HEAD_MODEL.find(scene) is not None


def test_a_node_deleted_while_it_is_read_stays_deleted_and_one_without_display_is_filled(
    scene, loading, imaged
):
    showScenario(scene, imaged)
    loading.loader.process()
    scene.RemoveNode(loading.node)
    loading.finish()
    assert loading.node is None
    assert loading.problems == loading.shown == []
    showScenario(scene, imaged)
    scene.RemoveNode(loading.node.GetDisplayNode())
    loading.finish()
    assert loading.node.GetImageData() is not None


def test_a_saved_scene_carries_the_images_and_shows_them(imaged, tmp_path):
    headless = HeadlessScene()
    saved = Loading(headless.scene)
    showScenario(headless.scene, imaged)
    saved.finish()
    headless.save(tmp_path / "trial.mrb")
    imaged.volume.file.unlink()
    opened = HeadlessScene()
    load_bundle(opened, tmp_path / "trial.mrb")
    node = Role.HEAD_VOLUME.find(opened.scene)
    assert np.array_equal(slicer.util.arrayFromVolume(node).T, ball_volume().values)
    assert node.GetDisplayNode().GetWindow() == 120.0
    assert backgrounds(opened.scene) == [node.GetID()] * 3
    assert str(tmp_path) not in str(node)
