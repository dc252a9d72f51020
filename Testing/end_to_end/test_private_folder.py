"""Set up by Slicer's Python, the simulator and its processes run on their own packages alone."""

from __future__ import annotations

import contextlib
import os
import signal
import site
import sys
from importlib import metadata
from pathlib import Path

import pytest

import rastrainer
import rastrainer_simulator as simulator
from rastrainer.python_environment import private_command
from rastrainer.slicer.program.child_process import ChildProcess
from rastrainer.slicer.program.simulator_setup import CHECKOUT, PROGRAM
from Testing.end_to_end.virtual_display import VirtualDisplay
from Testing.running_process import runs, started_by
from Testing.slicer.host.python_slicer import write_python_slicer
from Testing.slicer.simulator_double import wait_until

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="what a process has loaded stands in /proc"
)
LONG_S = 120.0


@pytest.fixture(scope="module")
def slicer(tmp_path_factory):
    """The folder of a Slicer, with its Python."""
    home = tmp_path_factory.mktemp("installed") / "Slicer"
    write_python_slicer(home)
    return home


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A set-up from a checkout: packages in one folder, and one file leading to ours."""
    target = tmp_path_factory.mktemp("private") / "simulator"
    target.mkdir()
    for place in filter(Path.is_dir, map(Path, site.getsitepackages())):
        for entry in place.iterdir():
            if "rastrainer" not in entry.name:
                (target / entry.name).symlink_to(entry)
    sources = [str(Path(package.__file__).parents[1]) for package in (rastrainer, simulator)]
    (target / CHECKOUT).write_text("".join(f"{source}\n" for source in sources))
    return target


@pytest.fixture
def from_slicer(slicer, monkeypatch):
    """The environment of Slicer, whose own launcher has started it; return its Python."""
    monkeypatch.setenv("LD_LIBRARY_PATH", "/opt/of the user")
    for name in dict(os.environ):
        monkeypatch.setenv(f"APPLAUNCHER_0_{name}", os.environ[name])
    monkeypatch.setenv("APPLAUNCHER_LEVEL", "1")
    monkeypatch.setenv("SLICER_HOME", str(slicer))
    monkeypatch.setenv("PYTHONHOME", str(slicer / "lib" / "Python"))
    monkeypatch.setenv("PYTHONPATH", str(slicer / "bin" / "Python"))
    monkeypatch.setenv("LD_LIBRARY_PATH", f"{slicer}/lib/Slicer-5.13:/opt/of the user")
    monkeypatch.setenv("QML2_IMPORT_PATH", f"{slicer}/lib/qml")
    return slicer / "bin" / "PythonSlicer"


def run(words):
    """Return the output of a program of the private folder."""
    child, lines = ChildProcess(words), []
    wait_until(lambda: lines.extend(child.takeLines()) or child.poll(), lambda: None, LONG_S)
    return [*lines, *child.takeLines()]


def test_a_program_sees_no_package_of_slicer_and_the_environment_before_its_launcher(
    from_slicer, folder
):
    (folder / "look_around.py").write_text(
        "import importlib.util, os, sys\n"
        "print(importlib.util.find_spec('slicers_own_package'))\n"
        "print([place for place in sys.path if 'Slicer' in place])\n"
        "print(sorted(name for name, value in os.environ.items() if 'Slicer' in value))\n"
        "print(os.environ['LD_LIBRARY_PATH'])\n"
        "print(sys.argv)\n"
    )
    assert run(private_command(from_slicer, folder, "look_around", "--a", "b c")) == [
        "None",
        "[]",
        "['RASTRAINER_STARTED_BY']",
        "/opt/of the user",
        f"[{str(folder / 'look_around.py')!r}, '--a', 'b c']",
    ]


def test_the_simulator_and_its_window_use_nothing_from_slicers_folder_and_end_together(
    from_slicer, folder, slicer, tmp_path, monkeypatch
):
    with VirtualDisplay() as display:
        monkeypatch.setenv("DISPLAY", display.name)
        monkeypatch.setenv("APPLAUNCHER_0_DISPLAY", display.name)
        places = ["--records", str(tmp_path / "records"), "--config", str(tmp_path / "config")]
        options = ["simulator", "--port", "0", "--desktop", "--no-gamepad", *places]
        words = private_command(from_slicer, folder, PROGRAM, *options)
        child, lines = ChildProcess(words), []
        try:

            def window():
                lines.extend(child.takeLines())
                assert child.process.poll() is None, lines
                return [pid for pid in started_by(child.process.pid) if has_drawn(pid)]

            wait_until(window, lambda: None, LONG_S)
            pids = started_by(child.process.pid)
            # The real Python, and at least its window.
            assert len(pids) >= 2
            name = f"Pinocchio {metadata.version('pin')}"
            wait_until(
                lambda: lines.extend(child.takeLines()) or any(name in line for line in lines),
                lambda: None,
                LONG_S,
            )
            for pid in pids:
                # Short-lived processes that one of them has started may have ended.
                with contextlib.suppress(FileNotFoundError, ProcessLookupError):
                    assert str(slicer) not in Path(f"/proc/{pid}/maps").read_text()
                    assert str(slicer).encode() not in Path(f"/proc/{pid}/environ").read_bytes()
            # The real Python is the first; killing it ends the window, too.
            os.kill(pids[0], signal.SIGKILL)
            wait_until(child.poll, lambda: None, LONG_S)
            # Their ends of the output are closed a moment before they are gone.
            wait_until(lambda: not any(map(runs, pids)), lambda: None, LONG_S)
        finally:
            child.end()
            wait_until(child.poll, lambda: None, LONG_S)


def has_drawn(pid):
    """Return whether a process draws the page in the window."""
    try:
        return b"--type=renderer" in Path(f"/proc/{pid}/cmdline").read_bytes()
    except OSError:
        return False
