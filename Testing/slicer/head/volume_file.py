"""Write a volume as a file that Slicer reads, by Slicer's own writer."""

from __future__ import annotations

from pathlib import Path

import slicer

from rastrainer.slicer.head.volume import Volume
from Testing.slicer.head.placed import add_volume


def write_volume(path: Path, volume: Volume, is_compressed: bool = True) -> Path:
    """Write a volume in the format that the name ends with, such as `.nii.gz`; return its path."""
    scene = slicer.vtkMRMLScene()
    node = add_volume(scene, volume, "Volume")
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode(
        file_name=str(path), use_compression=is_compressed
    )
    assert storage.WriteData(node)
    return path
