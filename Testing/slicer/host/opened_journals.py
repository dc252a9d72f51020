"""The processes that open trials' journals: Slicer itself, or children of its Python."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from Testing.slicer.host.python_slicer import PACKAGES

SUFFIX = ".journal"
NOTE = f"""
import os, sys


def note(event, arguments):
    if event == "open" and arguments[1] == "r" and str(arguments[0]).endswith({SUFFIX!r}):
        file = os.open({{path!r}}, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.write(file, b"%d\\n" % os.getpid())
        os.close(file)


sys.addaudithook(note)
"""


class OpenedJournals:
    """Records the processes of Slicer's Python that read a journal, and Slicer itself.

    A note is made before the file is opened, which may take long.
    """

    def __init__(self, home: Path) -> None:
        """Have PythonSlicer in the host's folder of Slicer record openings from its next start."""
        self._path = home / "opened-journals"
        with (home / PACKAGES / "sitecustomize.py").open("a", encoding="utf-8") as program:
            program.write(NOTE.format(path=str(self._path)))
        self._is_open = True
        self._count_here = 0
        sys.addaudithook(self._note_here)

    def pids(self) -> list[int]:
        """Return the process of each opening so far."""
        beside = self._path.read_text().split() if self._path.exists() else []
        return [*map(int, beside), *[os.getpid()] * self._count_here]

    def close(self) -> None:
        """Record nothing more of this process; Python cannot remove its hook."""
        self._is_open = False

    def _note_here(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self._is_open and event == "open" and arguments[1] == "r":
            self._count_here += str(arguments[0]).endswith(SUFFIX)
