"""Write a volume as a file that Slicer reads, by Slicer's own writer."""

from __future__ import annotations

from pathlib import Path

import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.slicer.head.volume import Volume


def write_volume(path: Path, volume: Volume, is_compressed: bool = True) -> Path:
    """Write a volume in the format that the name ends with, such as `.nii.gz`; return its path."""
    image = vtk.vtkImageData()
    image.SetDimensions(volume.values.shape)
    image.GetPointData().SetScalars(numpy_to_vtk(volume.values.ravel(order="F"), deep=True))
    matrix = vtk.vtkMatrix4x4()
    matrix.DeepCopy(volume.ijkToRas.ravel().tolist())
    scene = slicer.vtkMRMLScene()
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    node.SetAndObserveImageData(image)
    node.SetIJKToRASMatrix(matrix)
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode()
    storage.SetFileName(str(path))
    storage.SetUseCompression(is_compressed)
    assert storage.WriteData(node)
    return path
