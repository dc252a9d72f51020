"""Point lists and how two of them are paired."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair

XYZ = np.arange(9.0).reshape(3, 3)


def test_labels_pair_points_in_any_order():
    labels, moving, fixed = pair(
        PointList(("a", "b", "c"), XYZ), PointList(("c", "a", "b"), XYZ * 10)
    )
    assert labels == ("a", "b", "c")
    np.testing.assert_array_equal(moving, XYZ)
    np.testing.assert_array_equal(fixed, XYZ[[1, 2, 0]] * 10)


@pytest.mark.parametrize(
    ("moving_labels", "fixed_labels", "labels"),
    [
        ((), (), ("1", "2", "3")),
        (("", "", ""), ("a", "b", "c"), ("a", "b", "c")),
        (("c", "b", "a"), (), ("c", "b", "a")),
    ],
)
def test_points_are_paired_by_order_unless_both_lists_have_labels(
    moving_labels, fixed_labels, labels
):
    paired, moving, fixed = pair(PointList(moving_labels, XYZ), PointList(fixed_labels, XYZ * 10))
    assert paired == labels
    np.testing.assert_array_equal(fixed, moving * 10)


def test_points_without_a_partner_are_named():
    with pytest.raises(InputError, match="c is only in the moving list and d, e are only in the"):
        pair(PointList(("a", "b", "c"), XYZ), PointList(("a", "b", "d", "e"), np.eye(4, 3)))
    with pytest.raises(InputError, match="3 moving and 4 fixed points"):
        pair(PointList((), XYZ), PointList(("a", "b", "d", "e"), np.eye(4, 3)))


@pytest.mark.parametrize(
    ("labels", "points", "words"),
    [
        ((), [], "at least one point"),
        ((), [[1.0, 2.0]], "three coordinates"),
        (("a", "b"), XYZ, "2 labels for 3 points"),
        (("a", "b", "a"), XYZ, '"a" is given to two points'),
        (("a", "", "b"), XYZ, "Point 2 has no label although others have"),
        (("a", "b", "c\n"), XYZ, "label of point 3 must be printable"),
        (("a", "b", "c" * 65), XYZ, "label of point 3 must be printable"),
        (("a", "b", "c"), XYZ * [1, 1, np.nan], 'Point "a" has a coordinate that is not a number'),
        ((), XYZ + 1e6, "Point 1 has a coordinate"),
    ],
)
def test_invalid_lists_are_refused(labels, points, words):
    with pytest.raises(InputError, match=words):
        PointList(labels, points)


def test_a_point_list_copies_its_points():
    points = XYZ.copy()
    point_list = PointList((), points)
    points[:] = 0
    np.testing.assert_array_equal(point_list.points, XYZ)
    with pytest.raises(ValueError, match="read-only"):
        point_list.points[0, 0] = 1
