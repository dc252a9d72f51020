"""Logs are lines of JSON, never grow too big, and never block."""

import json
import logging
import threading

import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.ops import log_files
from rastrainer_simulator.ops.log_files import MAX_WAITING, BackgroundHandler, keep_logs
from Testing.forked_child import in_child

OURS = logging.getLogger("rastrainer_simulator.some_part")


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    """Have a log that ends wait for its lines however slow the disk is."""
    monkeypatch.setattr(log_files, "CLOSE_TIMEOUT_S", 60.0)


def lines(path):
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_each_record_is_one_line_of_json_with_time_level_and_data(tmp_path):
    with keep_logs(tmp_path / "logs", "simulator"):
        OURS.info("The trial is %s.\nReally.", "über", extra={"data": {"points": 3}})
        logging.getLogger("somebody.else").info("chatter")
    (line,) = lines(tmp_path / "logs" / "simulator.log")
    assert line["message"] == "The trial is über.\nReally."
    assert (line["level"], line["logger"], line["data"]) == ("info", OURS.name, {"points": 3})
    assert line["utc"].endswith("Z")


def test_the_files_rotate_and_the_oldest_is_deleted(tmp_path, monkeypatch):
    monkeypatch.setattr(log_files, "LARGEST_FILE", 2000)
    with keep_logs(tmp_path, "simulator"):
        for number in range(1000):
            OURS.info("line %d", number)
    files = sorted(tmp_path.glob("*.log*"))
    assert len(files) == 1 + log_files.OLDER_FILES
    assert all(file.stat().st_size <= 2000 for file in files)
    assert lines(tmp_path / "simulator.log")[-1]["message"] == "line 999"


def log_one_line(folder):
    with keep_logs(folder, "simulator"):
        OURS.info("the second")
    return True


def test_two_programs_with_one_name_log_to_two_files_and_the_next_one_to_the_first(tmp_path):
    with keep_logs(tmp_path, "simulator"):
        OURS.info("the first")
        assert in_child(log_one_line, tmp_path)
    with keep_logs(tmp_path, "simulator"):
        OURS.info("the third")
    first, second = lines(tmp_path / "simulator.log"), lines(tmp_path / "simulator-2.log")
    assert [line["message"] for line in first] == ["the first", "the third"]
    assert [line["message"] for line in second] == ["the second"]


def test_a_crash_is_logged_with_its_traceback_and_a_refusal_with_its_message(tmp_path):
    with pytest.raises(ZeroDivisionError), keep_logs(tmp_path, "crashed"):
        1 / 0  # noqa: B018
    (line,) = lines(tmp_path / "crashed.log")
    assert line["level"] == "critical"
    assert "ZeroDivisionError" in line["traceback"]
    with pytest.raises(InputError), keep_logs(tmp_path, "refused"):
        raise InputError("The port is taken.")
    assert [line["message"] for line in lines(tmp_path / "refused.log")] == ["The port is taken."]


def test_a_folder_that_cannot_be_written_to_is_reported_once_and_nothing_else_changes(
    tmp_path, capsys
):
    (tmp_path / "file").write_text("notes")
    with keep_logs(tmp_path / "file" / "logs", "simulator"):
        OURS.info("to nobody")
    assert capsys.readouterr().err.count("There is no log") == 1


def test_a_message_from_outside_can_create_neither_a_second_line_nor_a_huge_one(tmp_path):
    with keep_logs(tmp_path, "simulator"):
        OURS.warning("%s", 'x\n{"level":"info"}' + "y" * 100_000)
    (line,) = lines(tmp_path / "simulator.log")
    assert len(line["message"]) == 8000


class Blocked(logging.Handler):
    """Accepts nothing until it is released."""

    def __init__(self):
        super().__init__()
        self.reached = threading.Event()
        self.go = threading.Event()
        self.taken = []

    def emit(self, record):
        self.reached.set()
        self.go.wait()
        self.taken.append(record.getMessage())


def record(text):
    return logging.LogRecord("rastrainer", logging.WARNING, __file__, 1, text, None, None)


def test_a_stalled_log_blocks_nobody_keeps_the_first_lines_and_counts_the_rest():
    blocked = Blocked()
    aside = BackgroundHandler(blocked)
    aside.handle(record("0"))
    blocked.reached.wait()
    for number in range(1, 3 * MAX_WAITING):
        aside.handle(record(str(number)))
    blocked.go.set()
    aside.close()
    *kept, gap = blocked.taken
    assert kept == [str(number) for number in range(len(kept))]
    assert len(kept) == MAX_WAITING + 1
    assert (
        gap == f"{2 * MAX_WAITING - 1} lines are missing here: they could not be written in time."
    )
