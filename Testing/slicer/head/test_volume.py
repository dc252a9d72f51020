import numpy as np
import pytest
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import Volume, imageOfNode
from rastrainer_headless.volume_files import readVolume
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


def test_a_file_that_is_missing_or_no_volume_is_refused_with_a_message(tmp_path):
    with pytest.raises(InputError, match=r"none\.nii\.gz does not exist"):
        readVolume(tmp_path / "none.nii.gz")
    path = tmp_path / "noise.nii.gz"
    path.write_bytes(b"not an image" * 100)
    with pytest.raises(InputError, match="could not be read as a volume"):
        readVolume(path)
