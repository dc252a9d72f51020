"""A simulator left behind by a crash of Slicer is found; no other process is ever ended."""

import contextlib
import os
import signal
import subprocess
import sys
from unittest.mock import Mock

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.folder import STARTED_BY, read_holder
from rastrainer.sections import simulator_logic
from rastrainer.sections.simulator_logic import RunningSimulator
from rastrainer.slicer.program.child_process import OPTIONS
from rastrainer_simulator.record.journal_writer import RecordsFolder
from Testing.slicer.simulator_double import wait_until

LONG_S = 60.0
SIMULATOR = """
import pathlib, signal, subprocess, sys, time
from rastrainer_simulator.record.journal_writer import RecordsFolder
if "stubborn" in sys.argv:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
records = RecordsFolder(pathlib.Path(sys.argv[1]))
subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
records.announce("0.0.0.0", 18999, "http://127.0.0.1:18945")
print("ready", flush=True)
time.sleep(600)
"""


@pytest.fixture
def left_behind(tmp_path):
    """Return a function that starts a simulator as Slicer does; it is ended after the test."""
    started = []

    def start(*words):
        process = subprocess.Popen(
            [sys.executable, "-c", SIMULATOR, str(tmp_path), *words],
            stdout=subprocess.PIPE,
            env={**os.environ, STARTED_BY: "Slicer"},
            **OPTIONS,
        )
        started.append(process)
        assert process.stdout.readline() == b"ready\n"
        return process

    yield start
    for process in started:
        if process.returncode is None:
            end_group(process)


def end_group(process):
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


@pytest.fixture
def running(tmp_path):
    return RunningSimulator(tmp_path, Mock())


@pytest.mark.parametrize("words", [(), ("stubborn",)])
def test_a_leftover_simulator_is_found_connected_to_and_ended_with_its_window(
    left_behind, running, monkeypatch, words
):
    monkeypatch.setattr(simulator_logic, "KILL_AFTER_S", 0.2)
    assert not running.look()
    with pytest.raises(InputError, match="no longer a simulator"):
        running.connect()
    process = left_behind(*words)
    assert running.look()
    assert (running.holder.pid, running.holder.started_by) == (process.pid, "Slicer")
    assert running.sentence.startswith("A simulator that was not started from here is running")
    assert " since 20" in running.sentence
    running.connect()
    running._link.connectTo.assert_called_once_with("127.0.0.1", 18999)
    running.end()
    assert running.isEnding
    assert running.sentence == "The simulator that was already running is ending."
    running._link.disconnect.assert_called_once_with()
    wait_until(lambda: running.holder is None, running.process, LONG_S)
    # The window holds the other end of this pipe.
    assert process.stdout.read() == b""
    assert process.wait() == -(signal.SIGKILL if words else signal.SIGTERM)


def test_a_simulator_started_after_the_displayed_one_is_not_ended(left_behind, running):
    first = left_behind()
    running.look()
    end_group(first)
    second = left_behind()
    running.end()
    assert not running.isEnding
    assert second.poll() is None
    assert running.holder.pid == second.pid


def test_a_simulator_started_by_a_person_is_ended_without_its_shell(running, tmp_path):
    shell = f"{sys.executable} -c '{SIMULATOR}' {tmp_path} & wait; echo the shell lives"
    process = subprocess.Popen(["sh", "-c", shell], stdout=subprocess.PIPE, **OPTIONS)
    assert process.stdout.readline() == b"ready\n"
    running.look()
    assert running.holder.started_by == ""
    running.end()
    assert process.stdout.readline() == b"the shell lives\n"
    wait_until(lambda: running.holder is None, running.process, LONG_S)
    end_group(process)


def test_looking_for_a_simulator_does_not_prevent_one_from_starting(tmp_path):
    look = "import sys, pathlib; from rastrainer.journal.folder import read_holder\n"
    look += "print(flush=True)\nwhile True: read_holder(pathlib.Path(sys.argv[1]))"
    RecordsFolder(tmp_path).close()
    words = [sys.executable, "-c", look, str(tmp_path)]
    with subprocess.Popen(words, stdout=subprocess.PIPE) as process:
        process.stdout.readline()
        for _round in range(50):
            RecordsFolder(tmp_path).close()
        process.kill()
    assert read_holder(tmp_path) is None
