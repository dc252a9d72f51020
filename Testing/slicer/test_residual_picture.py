"""The picture shows every point of the registration, colored, on the head."""

import numpy as np
import pytest
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.registration.registration import register
from rastrainer.slicer.scene.error_colors import (
    RESIDUAL_SCALARS,
    glyphsPolyData,
    magnification,
    showResidualArrows,
)
from rastrainer_headless.residual_picture import HEIGHT, WIDTH, writeResidualPicture
from Testing.domain.scenario.made_up_scenario import ball_head
from Testing.touched_head import head_points


@pytest.fixture
def registration():
    random = np.random.default_rng(11)
    fixed = head_points(random)
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


def test_large_residuals_are_magnified_less_and_none_causes_no_trouble():
    fixed = np.random.default_rng(2).normal(0.0, 70.0, (15, 3))
    for shift, expected in ((2.0, 10.0), (6.0, 5.0), (30.0, 1.0)):
        moving = fixed.copy()
        moving[3, 0] += shift
        assert magnification(register(moving, fixed)) == expected
    data = glyphsPolyData(register(50.0 * np.eye(3), 50.0 * np.eye(3)))
    assert np.isfinite(vtk_to_numpy(data.GetPoints().GetData())).all()


def test_the_arrows_are_a_colored_model_in_the_scene(scene, registration):
    node = showResidualArrows(scene, registration)
    assert node.GetPolyData().GetPointData().GetArray(RESIDUAL_SCALARS) is not None
    assert node.GetDisplayNode().GetScalarVisibility()
    assert showResidualArrows(scene, registration) is node


def test_the_picture_shows_head_points_and_legend(registration, tmp_path):
    path = tmp_path / "residuals.png"
    writeResidualPicture(path, ball_head(90.0), registration, "Task 1", ["a caption"])
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
