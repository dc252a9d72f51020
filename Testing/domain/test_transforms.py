"""Transforms map points of their first frame to the second."""

import numpy as np
from scipy.spatial.transform import Rotation

from rastrainer import transforms


def test_apply_agrees_with_scipys_rotations():
    rotation = Rotation.from_euler("xyz", [0.3, -1.1, 2.0])
    points = np.random.default_rng(1).normal(size=(20, 3))
    matrix = transforms.rigid(rotation.as_matrix(), [1.0, 2.0, 3.0])
    np.testing.assert_allclose(
        transforms.apply(matrix, points), rotation.apply(points) + np.arange(1, 4), atol=1e-14
    )


def test_a_single_point_keeps_its_shape():
    assert transforms.apply(np.eye(4), [1.0, 2.0, 3.0]).shape == (3,)


def test_the_inverse_of_an_affine_transform_undoes_it():
    rng = np.random.default_rng(2)
    matrix = transforms.rigid(rng.normal(size=(3, 3)), rng.normal(size=3))
    points = rng.normal(size=(5, 3))
    back = transforms.apply(transforms.inverse(matrix), transforms.apply(matrix, points))
    np.testing.assert_allclose(back, points, atol=1e-12)
