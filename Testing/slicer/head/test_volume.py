"""Volumes and heads lie where Slicer and VTK see them."""

import numpy as np
import pytest
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.head.volume import Volume, imageOfNode
from rastrainer_headless.volume_files import readVolume
from rastrainer_simulator.assets import asset_path
from Testing.slicer.head.placed import add_transform, add_volume


def test_a_voxel_is_found_where_slicer_places_it(scene):
    values = np.zeros((5, 6, 7), np.int16)
    values[1, 2, 3] = 100
    image = vtk.vtkImageData()
    image.SetDimensions(5, 6, 7)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    node.SetAndObserveImageData(image)
    node.SetSpacing(2.0, 3.0, 4.0)
    node.SetOrigin(-10.0, 20.0, 30.0)
    node.SetIJKToRASDirections(0, -1, 0, 1, 0, 0, 0, 0, 1)
    volume = imageOfNode(node)
    assert np.argwhere(volume.values == 100).tolist() == [[1, 2, 3]]
    assert (volume.ijkToRas @ [1, 2, 3, 1])[:3].tolist() == [-10 - 6, 20 + 2, 30 + 12]


def test_a_volume_lies_where_its_linear_transforms_place_it(scene):
    node = add_volume(scene, Volume(np.zeros((5, 6, 7), np.float32), np.eye(4)), "MRI")
    outer, inner = add_transform(scene, [1.0, 2.0, 3.0]), add_transform(scene, [10.0, 0.0, 0.0])
    inner.SetAndObserveTransformNodeID(outer.GetID())
    node.SetAndObserveTransformNodeID(inner.GetID())
    assert (imageOfNode(node).ijkToRas @ [1, 1, 1, 1])[:3].tolist() == [12, 3, 4]

    bent = scene.AddNewNodeByClass("vtkMRMLGridTransformNode", "Bent")
    bent.SetAndObserveTransformToParent(vtk.vtkThinPlateSplineTransform())
    node.SetAndObserveTransformNodeID(bent.GetID())
    with pytest.raises(InputError, match="has the parent transform Bent, which is not linear"):
        imageOfNode(node)


def test_a_file_that_is_no_volume_is_refused_with_a_message(tmp_path):
    path = tmp_path / "noise.nii.gz"
    path.write_bytes(b"not an image" * 100)
    with pytest.raises(InputError, match="could not be read as a volume"):
        readVolume(path)


HEAD = asset_path("scenarios", "colin27", "head.ply")


def vertices_in_slicer(scene, path):
    node = scene.AddNewNodeByClass("vtkMRMLModelNode")
    storage = slicer.vtkMRMLModelStorageNode(file_name=str(path))
    assert storage.ReadData(node)
    return vtk_to_numpy(node.GetPolyData().GetPoints().GetData())


def test_slicer_reads_the_head_in_ras(scene):
    mesh = read_head_mesh(HEAD)
    assert np.array_equal(vertices_in_slicer(scene, HEAD), mesh.vertices)


def test_the_comment_in_the_file_declares_ras(scene, tmp_path):
    lps = tmp_path / "head.ply"
    lps.write_bytes(HEAD.read_bytes().replace(b"SPACE=RAS", b"SPACE=LPS"))
    turned = read_head_mesh(HEAD).vertices * [-1, -1, 1]
    assert np.allclose(vertices_in_slicer(scene, lps), turned)


SCENARIO = load_scenario(asset_path("scenarios", "colin27"))
SKIN = 48.6
"""The threshold that the head was made with."""

COVERED_MM = ((-88.0, 88.0), (-123.0, 89.0), (-69.0, 107.0))
"""Where the scan covers the head: beyond it, nose and ears are extrapolated."""


@pytest.fixture(scope="module")
def volume():
    """The volume as Slicer's own reader has it."""
    return readVolume(SCENARIO.volume.file)


@pytest.fixture(scope="module")
def skin():
    """Positions (n, 3), RAS mm, on the head's skin that the scan covers."""
    vertices = read_head_mesh(SCENARIO.head).vertices.astype(float)
    low, high = np.array(COVERED_MM).T
    return vertices[((vertices > low) & (vertices < high)).all(axis=1)]


def image_of(volume):
    image = vtk.vtkImageData(dimensions=volume.values.shape, origin=volume.ijkToRas[:3, 3])
    image.GetPointData().SetScalars(numpy_to_vtk(volume.values.ravel(order="F"), deep=True))
    return image


def test_the_skin_in_the_mri_is_within_a_millimeter_of_the_head(volume, skin):
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image_of(volume))
    contour.SetValue(0, SKIN)
    contour.Update()
    locator = vtk.vtkStaticCellLocator()
    locator.SetDataSet(contour.GetOutput())
    locator.BuildLocator()
    found, cell, part, squared = [0.0] * 3, vtk.reference(0), vtk.reference(0), vtk.reference(0.0)
    distances = []
    for place in skin[::10]:
        locator.FindClosestPoint(place, found, cell, part, squared)
        distances.append(float(squared) ** 0.5)
    assert np.mean(distances) < 1.0
    assert np.percentile(distances, 95) < 2.0
