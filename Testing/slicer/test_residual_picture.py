"""The picture shows every point of the registration, colored, on the head."""

import numpy as np
import pytest
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.registration import register
from rastrainer.slicer.scene.error_colors import (
    RESIDUAL_SCALARS,
    glyphsPolyData,
    magnification,
    showResidualArrows,
)
from rastrainer_headless.residual_picture import (
    HEIGHT,
    WIDTH,
    chooseTwoViews,
    writeResidualPicture,
)


@pytest.fixture
def head():
    sphere = vtk.vtkSphereSource()
    sphere.SetRadius(90.0)
    sphere.SetThetaResolution(60)
    sphere.SetPhiResolution(40)
    sphere.Update()
    surface = sphere.GetOutput()
    return HeadMesh(
        vtk_to_numpy(surface.GetPoints().GetData()).astype(float),
        vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3),
    )


@pytest.fixture
def registration():
    random = np.random.default_rng(11)
    directions = random.normal(size=(15, 3))
    directions[:, 2] = np.abs(directions[:, 2])
    fixed = 90.0 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    return register(fixed + random.normal(0.0, 1.0, (15, 3)), fixed)


def test_an_arrow_is_a_multiple_of_its_residual_and_carries_it(registration):
    data = glyphsPolyData(registration, [4])
    points = vtk_to_numpy(data.GetPoints().GetData())
    reach = np.linalg.norm(points - registration.fixed_mm[4], axis=1).max()
    assert reach == pytest.approx(
        magnification(registration) * registration.residuals_mm[4], rel=0.01
    )
    scalars = vtk_to_numpy(data.GetPointData().GetArray(RESIDUAL_SCALARS))
    np.testing.assert_allclose(scalars, registration.residuals_mm[4])


@pytest.mark.parametrize(("shift", "expected"), [(2.0, 10.0), (6.0, 5.0), (30.0, 1.0)])
def test_large_residuals_are_magnified_less(shift, expected):
    fixed = np.random.default_rng(2).normal(0.0, 70.0, (15, 3))
    moving = fixed.copy()
    moving[3, 0] += shift
    assert magnification(register(moving, fixed)) == expected


def test_a_zero_residual_causes_no_trouble():
    fixed = 50.0 * np.eye(3)
    data = glyphsPolyData(register(fixed, fixed))
    assert np.isfinite(vtk_to_numpy(data.GetPoints().GetData())).all()


def test_the_arrows_are_a_colored_model_in_the_scene(scene, registration):
    node = showResidualArrows(scene, registration)
    assert node.GetPolyData().GetPointData().GetArray(RESIDUAL_SCALARS) is not None
    assert node.GetDisplayNode().GetScalarVisibility()
    assert showResidualArrows(scene, registration) is node


def test_each_point_faces_one_of_the_two_cameras(registration):
    outward = registration.fixed_mm / np.linalg.norm(registration.fixed_mm, axis=1)[:, None]
    facing = chooseTwoViews(outward) @ outward.T
    assert facing.max(axis=0).min() > 0.2


def test_the_picture_shows_head_points_and_legend(head, registration, tmp_path):
    path = tmp_path / "residuals.png"
    writeResidualPicture(path, head, registration, "Task 1", ["a caption"])
    reader = vtk.vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    assert image.GetDimensions()[:2] == (WIDTH, HEIGHT)
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(HEIGHT, WIDTH, -1)[..., :3]
    saturation = np.ptp(pixels.astype(int), axis=2)
    heads, legend = pixels[:, : int(0.9 * WIDTH)], saturation[:, int(0.9 * WIDTH) :]
    assert (heads.astype(int).max(axis=2) < 250).mean() > 0.3
    assert (saturation[:, : int(0.9 * WIDTH)] > 60).sum() > 15 * 100
    assert (legend > 60).sum() > 5000
    assert [item.name for item in tmp_path.iterdir()] == ["residuals.png"]
