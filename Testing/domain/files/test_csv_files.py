"""Points and trials from valid and invalid CSV files."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, read_points, write_markups
from rastrainer.trial.ctps import read_trials

HEADER = "mode,subject,task,ct,rmse\n"


def file(tmp_path, text, name="a.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize(
    ("text", "labels"),
    [
        ("label,x,y,z\na,1,2,3\nb,4,5,6\n", ("a", "b")),
        ("x,y,z\r\n1,2,3\r\n4,5,6\r\n", ()),
        ("label,x,y,z\n,1,2,3\n,4,5,6\n", ()),
        ("\ufeffX, Y ,Z,label,note\n\n1,2,3, a ,x\n4,5,6,b,\n\n", ("a", "b")),
    ],
)
def test_points_are_read_with_or_without_labels(text, labels, tmp_path):
    point_list = read_points(file(tmp_path, text))
    assert point_list.labels == labels
    np.testing.assert_array_equal(point_list.points, [[1, 2, 3], [4, 5, 6]])


def test_a_name_that_ends_in_json_is_a_markups_file(tmp_path):
    write_markups(tmp_path / "F.mrk.json", PointList(("a",), [[1.0, 2.0, 3.0]]))
    assert read_points(tmp_path / "F.mrk.json").labels == ("a",)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        ("\n\n", "with the header label,x,y,z"),
        ("1,2,3\n4,5,6\n", "with the header label,x,y,z"),
        ("label;x;y;z\na;1;2;3\n", "with the header label,x,y,z"),
        ("label,x,y,z,z\na,1,2,3,4\n", "with the header label,x,y,z"),
        ("label,x,y,z\n", "has a header but no rows"),
        ("label,x,y,z\na,1,2\n", "Line 2 .* has 3 cells; the header has 4"),
        ("label,x,y,z\na,1,2,nan\n", "Line 2 .* z must be a number"),
        ("label,x,y,z\na,1,2,3\nb,1,inf,3\n", "Line 3 .* y must be a number"),
        ("label,x,y,z\na,1e400,2,3\n", "x must be a number"),
        ("label,x,y,z\na,1,2,three\n", "z must be a number .* not 'three'"),
        ("label,x,y,z\na,1,2,3\na,4,5,6\n", '"a" is given to two points'),
        ("label,x,y,z\na,1,2,3\n,4,5,6\n", "Point 2 has no label"),
        ('label,x,y,z\n"a,1,2,3\n', "not a CSV file: line 2"),
        (b"label,x,y,z\n\xff,1,2,3\n", "not UTF-8"),
        (b"\0" * 100, "not a text file"),
        ("x,y,z\n" + "1" * 200_000 + ",2,3\n", "not a CSV file"),
    ],
)
def test_unusable_point_files_raise_a_one_sentence_error(text, words, tmp_path):
    with pytest.raises(InputError, match=words) as caught:
        read_points(file(tmp_path, text))
    assert "\n" not in str(caught.value)


def test_trials_are_read_with_their_units(tmp_path):
    (trial,) = read_trials(file(tmp_path, HEADER + "hmd,Anne,task-1,114.3,1.10\n"))
    assert (trial.mode, trial.subject, trial.task) == ("hmd", "Anne", "task-1")
    assert (trial.completion_time_s, trial.rmse_mm) == (114.3, 1.1)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("hmd,a,1,0,1", "ct must be above 0"),
        ("hmd,a,1,-5,1", "ct must be a number from 0"),
        ("hmd,a,1,10,-1", "rmse must be a number from 0"),
        ("hmd,a,1,10,nan", "rmse must be a number"),
        ("hmd,,1,10,1", "subject must be printable text"),
        (",a,1,10,1", "mode must be printable text"),
        ("hmd,a,x\x07,10,1", "task must be printable text"),
        ("hmd,a,1,10", "has 4 cells"),
    ],
)
def test_invalid_trials_are_reported_with_their_line(row, words, tmp_path):
    with pytest.raises(InputError, match=f"Line 3 .*{words}"):
        read_trials(file(tmp_path, HEADER + "hmd,a,1,10,1\n" + row + "\n"))


def test_a_wrong_header_is_answered_with_the_right_one(tmp_path):
    with pytest.raises(InputError, match="with the header mode,subject,task,ct,rmse"):
        read_trials(file(tmp_path, "mode,subject,task,time,error\nhmd,a,1,10,1\n"))
