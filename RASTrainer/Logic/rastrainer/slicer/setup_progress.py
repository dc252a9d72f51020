"""How far a set-up is, read from what pip says."""

from __future__ import annotations

import re

ENTRY = re.compile(r"^[a-z0-9][A-Za-z0-9._-]* ?(?:==|@)", re.MULTILINE)
BEGUN = re.compile(r"(?:Collecting|Processing) \S")
LEFT_OUT = "Ignoring "
INSTALLING = "Installing collected packages"


class SetupProgress:
    """Counts packages.

    Attributes:
        done: packages that pip has fetched, or is fetching.
        count: packages that it is to fetch on this computer.
        isInstalling: whether all are there and are being put into the folder.
    """

    def __init__(self, requirements: str) -> None:
        """Begin with all entries of what pip is to install."""
        self.done = 0
        self.count = len(ENTRY.findall(requirements))
        self.isInstalling = False

    def follow(self, line: str) -> None:
        """Take a line of pip's into account."""
        if BEGUN.match(line):
            self.done = min(self.done + 1, self.count)
        elif line.startswith(LEFT_OUT):
            # Entries for other platforms and other versions of Python.
            self.count -= 1
        elif line.startswith(INSTALLING):
            self.isInstalling = True
