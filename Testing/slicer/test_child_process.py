"""What Slicer starts by its Python, a launcher, ends as a whole, and never makes Slicer wait."""

import contextlib
import os
import signal
import sys

import pytest

from rastrainer.slicer.program import child_process
from rastrainer.slicer.program.child_process import ChildProcess, runChild
from rastrainer.slicer.program.simulator_program import ProgramState, SimulatorProgram
from Testing.running_process import runs
from Testing.slicer.host.python_slicer import write_python_slicer
from Testing.slicer.simulator_double import wait_until

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the launcher's double is a POSIX script")

LONG_S = 60.0

WRITER = """
import os, pathlib, sys, time
(pathlib.Path(sys.argv[1]) / "pid").write_text(str(os.getpid()))
print("begun", flush=True)
print("  0%  Writing", flush=True)
time.sleep(600)
"""
SIMULATOR = """
import os, pathlib, signal, subprocess, sys, time
folder = pathlib.Path(sys.argv[1])
if "stubborn" in sys.argv:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
window = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
(folder / "window").write_text(str(window.pid))
(folder / "pid").write_text(str(os.getpid()))
print("RASTrainer simulator ready on 127.0.0.1:18944")
print("RASTrainer simulator computes the robot's kinematics by numpy 2.0", flush=True)
time.sleep(600)
"""


class CanceledError(Exception):
    """The work is no longer wanted."""


def ends(path):
    """Wait until the process whose number a file holds is gone.

    Its end of the output is closed a moment before that.
    """
    wait_until(lambda: not runs(number(path)), lambda: None, LONG_S)


@pytest.fixture
def python(tmp_path):
    return write_python_slicer(tmp_path / "Slicer")


@pytest.fixture
def started(python, tmp_path):
    """Starts a simulator with a window by the launcher; it is killed after the test."""

    def start(*words):
        program = SimulatorProgram()
        program.start([str(python), "-c", SIMULATOR, str(tmp_path), *words])
        wait_until(lambda: program.state is ProgramState.READY, program.process, LONG_S)
        return program

    yield start
    for name in ("pid", "window"):
        kill(number(tmp_path / name))


@pytest.fixture
def program(started):
    return started()


def number(path):
    return int(path.read_text())


def kill(pid):
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, signal.SIGKILL)


def test_canceled_work_ends_with_the_real_python(python, tmp_path):
    def cancel(step, _share):
        if step == "Writing":
            raise CanceledError

    with pytest.raises(CanceledError):
        runChild([python, "-c", WRITER, tmp_path], cancel)
    ends(tmp_path / "pid")


def test_work_runs_to_completion_with_its_steps_its_warnings_and_its_last_line(python):
    lines = [" 50%  Sawing", "Warning: It is loud.", "done", ""]
    steps = []
    code = f"print(*{lines!r}, sep=chr(10)); raise SystemExit(3)"
    ended = runChild([python, "-c", code], lambda *step: steps.append(step), "Beginning")
    assert (ended.exitStatus, ended.lastLine, ended.warnings) == (3, "done", ["It is loud."])
    assert steps[-1] == ("Sawing", 0.5)
    assert set(steps) <= {("Beginning", 0.0), ("Sawing", 0.5)}


def test_stop_ends_the_simulator_and_its_window_and_says_so(program, tmp_path):
    wait_until(lambda: "kinematics" in program.sentence, program.process, LONG_S)
    assert program.sentence == (
        "The simulator runs on port 18944. numpy 2.0 computes the robot's kinematics."
    )
    program.stop()
    assert (program.state, program.sentence) == (ProgramState.STOPPING, "The simulator is ending.")
    wait_until(lambda: program.state is ProgramState.STOPPED, program.process, LONG_S)
    ends(tmp_path / "pid")
    ends(tmp_path / "window")


def test_stop_does_not_wait_for_a_simulator_that_hangs_and_kills_it_later(
    started, tmp_path, monkeypatch
):
    monkeypatch.setattr(child_process, "KILL_AFTER_S", 0.2)
    program = started("stubborn")
    program.stop()
    assert program.state is ProgramState.STOPPING
    assert runs(number(tmp_path / "pid"))
    wait_until(lambda: program.state is ProgramState.STOPPED, program.process, LONG_S)
    ends(tmp_path / "pid")


def test_a_killed_simulator_is_noticed_although_its_window_is_open_and_takes_it_along(
    program, tmp_path
):
    kill(number(tmp_path / "pid"))
    wait_until(lambda: program.state is ProgramState.FAILED, program.process, LONG_S)
    assert "was ended from outside" in program.sentence
    assert "exit abnormally" not in program.sentence
    ends(tmp_path / "window")


def test_a_simulator_is_started_again_once_the_previous_one_has_ended(program, python, tmp_path):
    former = number(tmp_path / "pid")
    program.stop()
    program.start([str(python), "-c", SIMULATOR, str(tmp_path)])
    assert program.sentence == "The simulator is ending; it will then be started again."
    wait_until(lambda: program.state is ProgramState.READY, program.process, LONG_S)
    assert not runs(former)
    assert number(tmp_path / "pid") != former


def test_quitting_slicer_leaves_no_simulator_behind_even_if_it_hangs(started, tmp_path):
    program = started("stubborn")
    program.close()
    assert (program.state, program.isRunning) == (ProgramState.STOPPED, False)
    ends(tmp_path / "pid")
    ends(tmp_path / "window")


def test_a_crash_of_slicer_leaves_the_simulator_alone(tmp_path):
    """As for a trial that is to be finished; Slicer finds the simulator again."""
    slicer = (
        "import sys, time\n"
        "from rastrainer.slicer.program.child_process import ChildProcess\n"
        "child = ChildProcess([sys.executable, '-c', sys.argv[1], sys.argv[2]])\n"
        "while not any('kinematics' in line for line in child.takeLines()):\n"
        "    time.sleep(0.01)\n"
        "print('It has said all.', flush=True)\n"
        "time.sleep(600)\n"
    )
    child = ChildProcess([sys.executable, "-c", slicer, SIMULATOR, tmp_path])
    wait_until(lambda: "It has said all." in child.takeLines(), lambda: None, LONG_S)
    kill(child.process.pid)
    wait_until(lambda: child.process.poll() is not None, lambda: None, LONG_S)
    try:
        assert runs(number(tmp_path / "pid"))
        assert runs(number(tmp_path / "window"))
    finally:
        kill(number(tmp_path / "pid"))
        kill(number(tmp_path / "window"))
