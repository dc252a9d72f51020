"""Files are untrusted when read, also as JSON, and written as a whole."""

from __future__ import annotations

import json
import os

import pytest

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_text
from rastrainer.json_checks import (
    MAX_DEPTH,
    MAX_MESSAGE_VALUES,
    decode_finite_json,
    decode_message_object,
)

LIMIT = 1000


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


def nested(levels: int, opening: str, closing: str) -> str:
    return opening * levels + "1" + closing * levels


@pytest.mark.parametrize(("opening", "closing"), [("[", "]"), ('{"a":', "}"), ('[{"a":[', "]}]")])
def test_json_of_64_levels_is_accepted_and_of_65_refused(opening, closing):
    times, rest = divmod(MAX_DEPTH, len(closing))
    text = "[" * rest + nested(times, opening, closing) + "]" * rest
    assert decode_finite_json(text) is not None
    with pytest.raises(ValueError, match="too deeply nested"):
        decode_finite_json(f"[{text}]")


def test_a_message_with_too_many_values_is_refused_before_it_is_decoded():
    most = f'{{"values":[{",".join("1" * MAX_MESSAGE_VALUES)}]}}'
    assert len(decode_message_object(most, "It")["values"]) == MAX_MESSAGE_VALUES
    with pytest.raises(InputError, match=f"at most {MAX_MESSAGE_VALUES} values"):
        decode_message_object(most.replace("1", "1,1", 1), "It")
