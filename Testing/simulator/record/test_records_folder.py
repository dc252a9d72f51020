"""One simulator at a time records in a folder, and says why it cannot."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.cli import main
from rastrainer_simulator.record.records_folder import RecordsFolder
from Testing.forked_child import in_child


def take(folder):
    try:
        RecordsFolder(folder)
    except InputError as error:
        return str(error)
    return "taken"


def test_a_second_simulator_is_refused_with_a_sentence_that_names_the_first(tmp_path):
    first = RecordsFolder(tmp_path)
    assert in_child(take, tmp_path) == (
        f"Another simulator (process {os.getpid()}) records in {tmp_path}: end it, or choose "
        "another folder with --records."
    )
    first.close()
    assert in_child(take, tmp_path) == "taken"


def test_a_simulator_that_was_killed_leaves_the_folder_to_the_next(tmp_path):
    assert in_child(take, tmp_path) == "taken"
    RecordsFolder(tmp_path).close()


def test_rastrainer_simulator_says_that_another_one_records_there(tmp_path, capsys):
    records = RecordsFolder(tmp_path / "records")
    words = ["--port", "0", "--no-views", "--config", str(tmp_path / "config")]
    assert main(["simulator", "--records", str(tmp_path / "records"), *words]) == 2
    records.close()
    error = capsys.readouterr().err
    assert error.startswith("rastrainer: Another simulator")
    assert len(error.splitlines()) == 1


def take_without_rights(folder):
    if os.getuid() == 0:
        os.setuid(65534)
    return take(folder)


def test_a_read_only_folder_is_told_before_anyone_plays():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o555)
        said = in_child(take_without_rights, Path(folder))
        missing = in_child(take_without_rights, Path(folder, "trials"))
        Path(folder).chmod(0o755)
    assert said == (
        f"Trials cannot be recorded in {folder}: Permission denied. Allow writing to it, or "
        "choose another folder with --records."
    )
    assert "Permission denied" in missing


def test_a_file_in_the_place_of_the_folder_is_told(tmp_path):
    (tmp_path / "trials").write_text("my notes")
    with pytest.raises(InputError, match=r"cannot be recorded in .*trials: File exists"):
        RecordsFolder(tmp_path / "trials")
