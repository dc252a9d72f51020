"""Point lists pair by label or order, and are read from and written to markups, CSV and PLY."""

import json

import numpy as np
import pytest
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.files.point_files import SCHEMA, read_markups, read_points, write_markups
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
    with pytest.raises(InputError, match="No pair of points is left"):
        pair(PointList(("a",), XYZ[:1], {1: "b"}), PointList(("b",), XYZ[:1], {0: "a"}))


@pytest.mark.parametrize(
    ("labels", "points", "words"),
    [
        ((), [], "at least one point"),
        (("a", "b"), XYZ, "2 labels for 3 points"),
        (("a", "b", "a"), XYZ, '"a" is given to two points'),
        (("a", "b", "c"), XYZ * [1, 1, np.nan], 'Point "a" has a coordinate that is not a number'),
        ((), XYZ + 1e6, "Point 1 has a coordinate"),
    ],
)
def test_invalid_lists_are_refused(labels, points, words):
    with pytest.raises(InputError, match=words):
        PointList(labels, points)


POINTS = np.array([[1.5, -2.0, 3.25], [80.0, 0.125, -7.0], [-3.0, 40.0, 99.0]])


def slicer_node():
    scene = slicer.vtkMRMLScene()
    logic = slicer.vtkSlicerMarkupsLogic()
    logic.SetMRMLScene(scene)
    return scene, logic, scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "F")


def storage(scene, path):
    node = scene.AddNewNodeByClass("vtkMRMLMarkupsJsonStorageNode")
    node.SetFileName(str(path))
    return node


def document(**changes):
    markup = {
        "type": "Fiducial",
        "coordinateSystem": "RAS",
        "coordinateUnits": "mm",
        "controlPoints": [{"label": "1", "position": [1, 2, 3]}],
    }
    markup.update(changes)
    return {"@schema": SCHEMA, "markups": [markup]}


def written(path, content):
    path.write_text(content if isinstance(content, str) else json.dumps(content))
    return path


def test_points_that_slicer_saved_in_lps_are_read_in_ras(tmp_path):
    scene, _logic, node = slicer_node()
    for number, point in enumerate(POINTS, 1):
        node.AddControlPoint(vtk.vtkVector3d(*point), str(number))
    path = tmp_path / "F.mrk.json"
    assert storage(scene, path).WriteData(node)
    assert '"LPS"' in path.read_text()
    point_list = read_markups(path)
    assert point_list.labels == ("1", "2", "3")
    np.testing.assert_allclose(point_list.points, POINTS)


def test_slicer_opens_written_markups(tmp_path):
    path = tmp_path / "ours.mrk.json"
    write_markups(path, PointList(("a", "ü", "3"), POINTS / 3.0))
    np.testing.assert_array_equal(read_markups(path).points, POINTS / 3.0)
    scene, _logic, node = slicer_node()
    assert storage(scene, path).ReadData(node)
    assert [node.GetNthControlPointLabel(i) for i in range(3)] == ["a", "ü", "3"]
    for i, point in enumerate(POINTS):
        np.testing.assert_allclose(node.GetNthControlPointPositionWorld(i), point / 3.0)
        assert node.GetNthControlPointPositionStatus(i) == node.PositionDefined


def test_a_point_that_is_deselected_or_not_placed_is_left_out_or_named(tmp_path):
    scene, _logic, node = slicer_node()
    for row, label in enumerate("abcd"):
        node.AddControlPoint(vtk.vtkVector3d(row, 2, 3), label)
    node.SetNthControlPointPositionMissing(0)
    node.UnsetNthControlPointPosition(1)
    node.SetNthControlPointSelected(2, False)
    path = tmp_path / "F.mrk.json"
    storage(scene, path).WriteData(node)
    point_list = read_points(path)
    assert point_list.labels == ("d",)
    assert point_list.left_out == {0: "a", 1: "b", 2: "c"}
    with pytest.raises(InputError, match="place and select, or delete, a, b, c"):
        read_markups(path)
    node.SetNthControlPointSelected(3, False)
    storage(scene, path).WriteData(node)
    with pytest.raises(InputError, match="All its points are deselected or not placed"):
        read_points(path)


LEFT_OUT = PointList(("a", "c"), XYZ[[0, 2]], {1: "b"})


@pytest.mark.parametrize(
    ("moving", "fixed", "labels", "rows"),
    [
        (LEFT_OUT, PointList(("c", "b", "a"), XYZ), ("a", "c"), (2, 0)),
        (LEFT_OUT, PointList((), XYZ), ("a", "c"), (0, 2)),
        (PointList((), XYZ[:2], {0: ""}), PointList((), XYZ), ("2", "3"), (1, 2)),
        (
            PointList(("a", "b"), XYZ[:2], {0: "b"}),
            PointList(("b", "a"), XYZ[:2]),
            ("a", "b"),
            (1, 0),
        ),
    ],
)
def test_a_point_that_is_left_out_of_one_list_is_left_out_of_both(moving, fixed, labels, rows):
    for first, second in ((moving, fixed), (fixed, moving)):
        names, here, there = pair(first, second)
        assert {*names} == {*labels}
        assert len(here) == len(there) == len(labels)
    names, _, points = pair(moving, fixed)
    assert names == labels
    np.testing.assert_array_equal(points, fixed.points[list(rows)])


def test_a_file_without_coordinate_system_is_read_as_lps_and_mm(tmp_path):
    content = document()
    del content["markups"][0]["coordinateSystem"], content["markups"][0]["coordinateUnits"]
    point_list = read_markups(written(tmp_path / "a.mrk.json", content))
    np.testing.assert_array_equal(point_list.points, [[-1, -2, 3]])


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("not json", "not JSON"),
        ([], "not a markups file"),
        ({"@schema": SCHEMA}, "exactly one point list"),
        (document(type="Line"), "must be a point list"),
        (document(coordinateUnits="um"), "must be in mm"),
        (document(coordinateSystem="IJK"), "must be LPS or RAS"),
        (document(controlPoints=[]), "holds no points"),
        (document(controlPoints=[{"position": [1, 2]}]), "position of point 1"),
    ],
)
def test_other_files_are_refused_in_one_sentence_that_names_the_file(content, words, tmp_path):
    path = written(tmp_path / "bad.mrk.json", content)
    with pytest.raises(InputError, match=words) as caught:
        read_markups(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
