"""Files are untrusted when read, and written as a whole."""

import json
import os

import pytest

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json, read_text
from rastrainer.files.writing import write_text

LIMIT = 1000


def test_text_is_read_without_its_byte_order_mark(tmp_path):
    path = tmp_path / "a.txt"
    path.write_bytes(b"\xef\xbb\xbfna\xc3\xafve\n")
    assert read_text(path, LIMIT) == "naïve\n"


def test_neither_a_pipe_nor_a_huge_file_is_waited_for(tmp_path):
    path = tmp_path / "pipe"
    os.mkfifo(path)
    with pytest.raises(InputError, match="not a regular file"):
        read_text(path, LIMIT)
    with (tmp_path / "zeros").open("wb") as file:
        file.truncate(2**30)
    with pytest.raises(InputError, match="larger than"):
        read_text(tmp_path / "zeros", LIMIT)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "is empty"),
        (b"\xff\xfe\x00\x01", "not UTF-8"),
        (b"\0" * 10, "not a text file"),
        (b"x" * (LIMIT + 1), "larger than"),
    ],
)
def test_other_content_is_refused(content, words, tmp_path):
    path = tmp_path / "file"
    path.write_bytes(content)
    with pytest.raises(InputError, match=words):
        read_text(path, LIMIT)


@pytest.mark.parametrize("name", ["missing", "", "nul\0", "x" * 300, "missing/../file"])
def test_folders_and_devices_are_refused_in_one_sentence(name, tmp_path):
    with pytest.raises(InputError) as caught:
        read_text(str(tmp_path / name), LIMIT)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text",
    ["{", "[NaN]", "[1e999]", "[" * 900, "9" * 900 + "x", "[" * 400 + "]" * 400],
)
def test_json_must_have_finite_numbers(text, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(InputError, match="not JSON"):
        read_json(path, LIMIT)


def test_writing_replaces_the_old_file_and_leaves_nothing_behind(tmp_path):
    path = tmp_path / "a.json"
    path.write_text("old")
    path.chmod(0o640)
    write_text(path, json.dumps({"é": 1}, ensure_ascii=False))
    assert read_json(path, LIMIT) == {"é": 1}
    assert path.stat().st_mode & 0o777 == 0o640
    assert [p.name for p in tmp_path.iterdir()] == ["a.json"]
    (tmp_path / "usual").write_text("x")
    write_text(tmp_path / "new", "x")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_a_write_that_fails_keeps_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "a.txt"
    path.write_text("old")
    monkeypatch.setattr(os, "fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left")))
    with pytest.raises(InputError, match="cannot be written: no space left"):
        write_text(path, "new")
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["a.txt"]


def test_an_unwritable_path_is_reported(tmp_path):
    with pytest.raises(InputError, match="cannot be written: no such file or directory"):
        write_text(tmp_path / "missing" / "a.txt", "x")
    with pytest.raises(InputError, match="cannot be written: is a directory"):
        write_text(tmp_path, "x")
    with pytest.raises(InputError, match="cannot be written"):
        write_text(tmp_path / "nul\0", "x")
    assert list(tmp_path.iterdir()) == []
