"""Slicer's own model reader places the head where the MRI has it."""

import numpy as np
import slicer
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.head.mesh import read_head_mesh
from rastrainer_simulator.assets import asset_path

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
