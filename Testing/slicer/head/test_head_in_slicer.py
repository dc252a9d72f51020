"""Slicer's own model reader places the head where the MRI has it."""

import numpy as np
import pytest
import slicer
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.head.mesh import read_head_mesh
from rastrainer_simulator.assets import asset_path

HEAD = asset_path("scenarios", "colin27", "head.ply")


def vertices_in_slicer(scene, path):
    node = scene.AddNewNodeByClass("vtkMRMLModelNode")
    storage = slicer.vtkMRMLModelStorageNode()
    storage.SetFileName(str(path))
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


@pytest.mark.parametrize(
    ("place", "expected_ras"),
    [
        # Read off the MRI's slices, mm: where the skin is on the mid-sagittal plane.
        pytest.param("top", (0, -30, 103), id="top"),
        pytest.param("back", (0, -118, -16), id="back"),
    ],
)
def test_the_head_lies_where_the_mri_has_it(place, expected_ras):
    vertices = read_head_mesh(HEAD).vertices
    middle = vertices[np.abs(vertices[:, 0]) < 3]
    found = middle[middle[:, 2].argmax() if place == "top" else middle[:, 1].argmin()]
    axis = 2 if place == "top" else 1
    assert found[axis] == pytest.approx(expected_ras[axis], abs=2)
