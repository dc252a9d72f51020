"""Files are untrusted when read, and written as a whole."""

import json
import os

import pytest

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json, read_text
from rastrainer.files.writing import write_text

LIMIT = 1000


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
