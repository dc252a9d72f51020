"""The table of a class shows what report and Slicer show, follows the study, and outlives it."""

from __future__ import annotations

import re
import shutil
import time
from pathlib import Path

import pytest

from rastrainer.json_records import record_to_json
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.database.database import LockWait
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.board.class_table import ClassReader, class_table
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.report.trainees import curricula
from Testing.simulator.board.class_study import as_in_narrow_columns, play_class
from Testing.simulator.net.igtl.servers import PATIENCE_S
from Testing.simulator.net.views.served import request

NAMES = ["T001", "T002", "T003", "T004"]


@pytest.fixture(scope="module")
def played(tmp_path_factory) -> Path:
    """Return a study of four virtual trainees, which nothing changes."""
    path = tmp_path_factory.mktemp("class") / "study.db"
    play_class(path, NAMES, 12)
    return path


@pytest.fixture
def study(played, tmp_path) -> Path:
    return Path(shutil.copy(played, tmp_path / "study.db"))


@pytest.fixture
def reader(study):
    reader = ClassReader(study)
    yield reader
    reader.close()


def tables(reader: ClassReader, language: str = "en") -> list[dict]:
    """Return the tables that a page is sent."""
    found = class_table(reader.read(), language)
    return [record_to_json(table, with_defaults=True) for table in found]


def test_the_table_is_that_of_the_report(study):
    html = curricula(read_study_data(study))
    report = [re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row) for row in html.split("<tr>")[2:]]
    reader = ClassReader(study)
    (table,) = tables(reader)
    reader.close()
    assert table["title"] == "First steps"
    states = {cell["state"] for row in table["trainees"] for cell in row["cells"]}
    assert states == {"locked", "open", "reached"}
    shown = [
        [
            row["trainee"],
            f"{row['reached']} of {len(row['cells'])}",
            *map(as_in_narrow_columns, row["cells"]),
        ]
        for row in table["trainees"]
    ]
    assert shown == [[name, reached, *cells] for name, _n, reached, *cells in report]


def test_the_study_is_read_again_only_when_something_is_new(reader, study):
    first = reader.read()
    assert reader.read() is first
    with Study.open(study) as opened:
        opened.create_trainee("T099")
    second = reader.read()
    assert list(second) == [*NAMES, "T099"]
    with Study.open(study) as opened:
        CurriculumStore(opened).choose(None)
    assert reader.read() == dict.fromkeys([*NAMES, "T099"])


def test_a_file_that_replaces_the_study_is_noticed(reader, study, tmp_path):
    reader.read()
    restored = tmp_path / "restored.db"
    play_class(restored, ["Z"], 0)
    restored.replace(study)
    assert list(reader.read()) == ["Z"]


def test_reading_blocks_no_seat_and_no_seat_blocks_reading(reader, study):
    reader.read()
    before = study.read_bytes()
    with Study.open(study, LockWait(0.0)) as seat:
        seat.create_trainee("T100")
        with seat.database.writing():
            assert "T100" in reader.read()
    reader.read()
    assert study.read_bytes() != before


def until(board, is_wanted):
    """Return the board's message about the class once it meets a condition."""
    give_up = time.monotonic() + PATIENCE_S
    while True:
        status, found = board.ask("/class?language=en")
        assert status == 200
        if is_wanted(found):
            return found
        assert time.monotonic() < give_up, found


def test_while_the_study_is_unreachable_the_last_table_stays_and_the_page_is_informed(
    open_board, study, monkeypatch
):
    monkeypatch.setattr("rastrainer_simulator.board.class_table.ROUND_S", 0.05)
    board = open_board(study)
    first = until(board, lambda found: found["curricula"])
    assert first["problem"] == ""
    away = study.rename(study.with_suffix(".away"))
    gone = until(board, lambda found: found["problem"])
    assert gone["problem"] == f"There is no file {study}."
    assert gone["curricula"] == first["curricula"]
    assert until(board, lambda found: found["problem"])["asOf"] == gone["asOf"]
    away.rename(study)
    assert until(board, lambda found: not found["problem"])["curricula"] == first["curricula"]


def test_the_table_is_served_only_to_paired_clients_and_to_no_other_page(open_board, study):
    board = open_board(study)
    assert board.ask("/class", key="x" * 40)[0] == 401
    headers = {"Authorization": f"Bearer {board.key}", "Origin": "https://elsewhere.example"}
    assert request(board.url, "/class", headers=headers)[0] == 403
    assert board.ask("/class", "POST")[0] == 405
    assert board.ask("/class", key=board.paired("spectator"))[0] == 200


def test_the_command_reports_a_path_that_is_not_a_study(tmp_path, capsys):
    missing = tmp_path / "none.db"
    assert main(["board", "--config", str(tmp_path), "--port", "0", "--study", str(missing)]) != 0
    assert f"There is no file {missing}." in capsys.readouterr().err
