"""Points and trials from valid and invalid CSV files."""

import numpy as np
import pytest
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_points


def file(tmp_path, text, name="a.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize(
    ("text", "labels"),
    [
        ("label,x,y,z\na,1,2,3\nb,4,5,6\n", ("a", "b")),
        ("x,y,z\r\n1,2,3\r\n4,5,6\r\n", ()),
        ("\ufeffX, Y ,Z,label,note\n\n1,2,3, a ,x\n4,5,6,b,\n\n", ("a", "b")),
        ("label;x;y;z\na;1,0;2,00;3\nb;4;5;,6e1\n", ("a", "b")),
        ('sep=;\r\nlabel;x;y;z\r\n"a";1;2;3\r\nb;4,0;5;6\r\n', ("a", "b")),
        ('label,x,y,z\na,"1,0","2,0","3,0"\nb,4,"5,0",6\n', ("a", "b")),
        ("label;x;y;z\nä;1;2;3\nb;4;5;6\n".encode("utf-16"), ("ä", "b")),
        ("# by hand\n# in mm\nlabel,x,y,z\na,1,2,3\nb,4,5,6\n", ("a", "b")),
    ],
)
def test_points_are_read_with_or_without_labels(text, labels, tmp_path):
    point_list = read_points(file(tmp_path, text))
    assert point_list.labels == labels
    np.testing.assert_array_equal(point_list.points, [[1, 2, 3], [4, 5, 6]])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("label;x;y\na;1;2\n", "with the header label,x,y,z; its first line is 'label;x;y'"),
        ("label,x,y,z,z\na,1,2,3,4\n", "has two columns z"),
        ("label,x,y,z\na,1,5,2,5,3,5\n", "7 cells; the header has 4. A comma in a number"),
        ("label;x;y;z\na;1,5;2.5;3\n", "with commas and with points, '1,5' and '2.5'"),
        ("label,x,y,z\n", "has a header but no rows"),
        ("label,x,y,z\na,1,2\n", "Line 2 .* has 3 cells; the header has 4"),
        ("label,x,y,z\na,1,2,3\nb,1,inf,3\n", "Line 3 .* y must be a number"),
        ('label,x,y,z\n"a,1,2,3\n', "not a CSV file: line 2"),
        (b"label,x,y,z\n\xff,1,2,3\n", "not UTF-8"),
        ("# CoordinateSystem = IJK\nx,y,z\n1,2,3\n", "must be LPS or RAS, not 'IJK'"),
    ],
)
def test_unusable_point_files_raise_a_one_sentence_error(text, words, tmp_path):
    with pytest.raises(InputError, match=words) as caught:
        read_points(file(tmp_path, text))
    assert "\n" not in str(caught.value)


SLICER_4 = (
    "# Markups fiducial file version = 4.11\n{frame}# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,"
)
SLICER_4 += (
    "label,desc,associatedNodeID\nF_0,-1,-2,3,0,0,0,1,1,1,0,a,,\nF_1,-4,-5,6,0,0,0,1,1,1,0,b,,\n"
)
SLICER_3 = "# Fiducial List file /F.fcsv\n# numPoints = 2\n# columns = label,x,y,z,sel,vis\n"


@pytest.mark.parametrize(
    ("text", "signs"),
    [
        (SLICER_4.format(frame="# CoordinateSystem = LPS\n"), [1, 1, 1]),
        (SLICER_4.format(frame="# CoordinateSystem = 0\n"), [-1, -1, 1]),
        (SLICER_3 + "a,1,2,3,1,1\nb,4,5,6\n", [1, 1, 1]),
        ('"label","l","p","s","defined","selected"\n"a",-1,-2,3,1,1\n"b",-4,-5,6,1,1\n', [1, 1, 1]),
        ('"label","r","a","s","defined","selected"\n"a",1,2,3,1,1\n"b",4,5,6,1,1\n', [1, 1, 1]),
    ],
)
def test_lists_and_tables_of_slicer_are_read_in_ras(text, signs, tmp_path):
    point_list = read_points(file(tmp_path, text, "F.fcsv"))
    assert point_list.labels == ("a", "b")
    np.testing.assert_array_equal(point_list.points, np.array([[1, 2, 3], [4, 5, 6]]) * signs)


def test_what_slicer_writes_is_read_as_slicer_has_it(tmp_path):
    scene = slicer.vtkMRMLScene()
    logic = slicer.vtkSlicerMarkupsLogic()
    logic.SetMRMLScene(scene)
    node = scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "F")
    for label, point in zip("a,bcd", np.arange(15.0).reshape(5, 3), strict=True):
        node.AddControlPoint(vtk.vtkVector3d(*point), label)
    node.SetNthControlPointSelected(2, False)
    node.SetNthControlPointPositionMissing(3)
    storage = scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialStorageNode")
    storage.SetFileName(str(tmp_path / "F.fcsv"))
    assert storage.WriteData(node)
    for name, is_lps in (("lps.csv", True), ("ras.csv", False)):
        assert logic.ExportControlPointsToCSV(node, str(tmp_path / name), is_lps)
    for name in ("F.fcsv", "lps.csv", "ras.csv"):
        point_list = read_points(tmp_path / name)
        assert point_list.labels == ("a", ",", "d")
        assert point_list.left_out == {2: "b", 3: "c"}
        np.testing.assert_array_equal(point_list.points, [[0, 1, 2], [3, 4, 5], [12, 13, 14]])
