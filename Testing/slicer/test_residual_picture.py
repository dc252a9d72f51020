"""The arrows of residuals: as long as they say, and magnified as far as there is room."""

import numpy as np
import pytest
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.registration.registration import register
from rastrainer.slicer.scene.error_colors import (
    RESIDUAL_SCALARS,
    glyphsPolyData,
    magnification,
)
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
