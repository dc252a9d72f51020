"""What starts the simulator of this checkout from Slicer: a wheel to set it up, or a program."""

from __future__ import annotations

import shlex
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

PACKAGE = "rastrainer"
INFO = f"{PACKAGE}-0.dist-info"

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
    program = [sys.executable, "-m", "rastrainer_simulator.cli", *given, *options]
    os.execv(sys.executable, program)


if __name__ == "__main__":
    main()
"""


def write_wheel(folder: Path, pid_file: Path, options: Sequence[str]) -> Path:
    """Write the wheel into a folder and return the folder.

    Args:
        folder: that is made for it.
        pid_file: into which the simulator's process writes its number.
        options: further ones of `rastrainer simulator`.
    """
    folder.mkdir(parents=True)
    files = {
        "rastrainer_simulator/__init__.py": "",
        "rastrainer_simulator/cli.py": _cli(pid_file, options),
        f"{INFO}/METADATA": f"Metadata-Version: 2.1\nName: {PACKAGE}\nVersion: 0\n",
        f"{INFO}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\n"
        "Tag: py3-none-any\n",
    }
    files[f"{INFO}/RECORD"] = "".join(f"{name},,\n" for name in [*files, f"{INFO}/RECORD"])
    with zipfile.ZipFile(folder / f"{PACKAGE}-0-py3-none-any.whl", "w") as wheel:
        for name, text in files.items():
            wheel.writestr(name, text)
    return folder


def write_program(path: Path, pid_file: Path, options: Sequence[str]) -> Path:
    """Write a program like `rastrainer`, as a user may have installed it; return its path."""
    script = path.with_suffix(".py")
    script.write_text(_cli(pid_file, options), encoding="utf-8")
    path.write_text(f'#!/bin/sh\nexec {shlex.join([sys.executable, str(script)])} "$@"\n')
    path.chmod(0o755)
    return path


def _cli(pid_file: Path, options: Sequence[str]) -> str:
    return CLI.format(pid_file=str(pid_file), options=list(options))
