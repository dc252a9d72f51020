"""How pip sets the simulator up: by which Python, from where, regardless of user settings."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.slicer.translation import _

PYTHON_SLICER = "PythonSlicer"


def pythonSlicer(slicerHome: Path) -> Path:
    """Return Slicer's own Python for programs beside it, where Slicer has it or on the PATH."""
    suffix = ".exe" if sys.platform == "win32" else ""
    inside = slicerHome / "bin" / f"{PYTHON_SLICER}{suffix}"
    found = None if inside.is_file() else shutil.which(PYTHON_SLICER)
    return Path(found) if found else inside


ADDRESS = re.compile(r"https?://[^\s/]\S*")
OPTIONS = (
    # Neither pip's settings of this user nor its cache: what is installed is what the lock says,
    # and what was downloaded goes again with the private folder.
    "--isolated",
    "--no-cache-dir",
    "--disable-pip-version-check",
    "--no-input",
    "--progress-bar=off",
    # The lock holds all that is needed, and less than the packages ask for.
    "--no-deps",
    "--require-hashes",
    # Building from sources would run whatever they say, by tools that no lock fixes.
    "--only-binary=:all:",
)


@dataclass(frozen=True)
class SetupSource:
    """Where the packages of others come from; the hashes of the lock hold anywhere.

    Attributes:
        index: address of a package index; pip's own where empty.
        wheels: a folder of wheels to install from without network; None asks the index.
    """

    index: str = ""
    wheels: Path | None = None

    def pipArguments(self) -> list[str]:
        """Return what stands between `pip install` and what is installed.

        Raises:
            InputError: the folder holds no wheels, or the address is none.
        """
        if self.wheels is not None:
            if not any(self.wheels.glob("*.whl")):
                raise InputError(
                    _("There are no wheels (*.whl) in {path}.").format(path=self.wheels)
                )
            return [*OPTIONS, "--no-index", "--find-links", str(self.wheels)]
        if not self.index:
            return list(OPTIONS)
        if not ADDRESS.fullmatch(self.index):
            raise InputError(
                _(
                    "“{address}” is no address of a package index: it begins with https://, or "
                    "leave it empty."
                ).format(address=self.index)
            )
        return [*OPTIONS, "--index-url", self.index]


def pipEnvironment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment in which pip finds no settings but its arguments."""
    kept = {name: value for name, value in environment.items() if not name.startswith("PIP_")}
    # Alone, `--isolated` still reads the settings for all users of the computer.
    return {**kept, "PIP_CONFIG_FILE": os.devnull, "PYTHONNOUSERSITE": "1"}


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
