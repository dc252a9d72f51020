"""The MRI of the default scenario lies where its head does, as VTK and Slicer see it."""

import numpy as np
import pytest
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.scenario import load_scenario
from rastrainer_headless.volume_files import readVolume
from rastrainer_simulator.assets import asset_path

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


def test_the_default_volume_is_small_with_1_mm_voxels_and_a_window_from_air_to_bright_tissue(
    volume,
):
    assert SCENARIO.volume.file.stat().st_size < 6_000_000
    assert np.array_equal(volume.ijkToRas[:3, :3], np.eye(3))
    white = SCENARIO.volume.level + SCENARIO.volume.window / 2
    assert SCENARIO.volume.level == SCENARIO.volume.window / 2
    head = volume.values[volume.values > SKIN]
    assert 0.98 < (head <= white).mean() < 1.0
    assert vtk_to_numpy(image_of(volume).GetPointData().GetScalars()).max() <= 255
