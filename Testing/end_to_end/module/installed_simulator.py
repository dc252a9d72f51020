"""Starts the simulator of this checkout from Slicer, from a package or as a program."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from rastrainer.slicer.program.simulator_package import SimulatorPackage
from Testing.slicer.made_up_package import write_package

CLI = """
import os
import sys


def main():
    with open({pid_file!r}, "w") as file:
        file.write(str(os.getpid()))
    # The private folder must not hide the checkout's packages.
    os.environ.pop("PYTHONPATH", None)
    # No screen, no window.
    given = [argument for argument in sys.argv[1:] if argument != "--desktop"]
    options = {options!r} if given[:1] == ["simulator"] else []
    program = [sys.executable, "-m", "rastrainer_simulator.cli.main", *given, *options]
    os.execv(sys.executable, program)


if __name__ == "__main__":
    main()
"""


def bundled_package(folder: Path, pid_file: Path, options: Sequence[str]) -> SimulatorPackage:
    """Return a module's package that sets up the simulator of this checkout.

    Args:
        folder: created for it.
        pid_file: gets the number of the simulator's process.
        options: added to `rastrainer simulator`.
    """
    return write_package(folder, _cli(pid_file, options))


def write_program(path: Path, pid_file: Path, options: Sequence[str]) -> Path:
    """Write a program like `rastrainer`, as a user may have installed it; return its path."""
    script = path.with_suffix(".py")
    script.write_text(_cli(pid_file, options), encoding="utf-8")
    path.write_text(f'#!/bin/sh\nexec {shlex.join([sys.executable, str(script)])} "$@"\n')
    path.chmod(0o755)
    return path


def _cli(pid_file: Path, options: Sequence[str]) -> str:
    return CLI.format(pid_file=str(pid_file), options=list(options))
