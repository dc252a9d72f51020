"""The sources of a set-up: the simulator's wheel, the lock of all other packages, and pip.

Our own package never comes from an index: anyone who registered its name there would run code in
hospitals. An installed module has the wheel, known by its SHA-256. In a checkout the sources are
run as they are. The lock fixes all other packages by their hashes.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import platform
import re
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rastrainer import __version__
from rastrainer.errors import InputError
from rastrainer.files.reading import read_bytes, read_json, read_text
from rastrainer.slicer.translation import _

RESOURCES = Path("Resources", "RASTrainerSimulator")
"""In the module's folder."""
LOCK, SIZES = "requirements.lock", "sizes.json"
WHEEL = f"rastrainer-{__version__}-py3-none-any.whl"
LIMIT_BYTES = 200 * 2**20
DIGEST = re.compile(r"([0-9a-f]{64})  (\S+)\n")


@dataclass(frozen=True)
class SimulatorPackage:
    """The simulator as it comes with the module: the folder of lock, sizes and wheel.

    `checkout` is the repository that contains the module; None if the module was installed.
    """

    folder: Path
    checkout: Path | None = None

    @classmethod
    def of(cls, moduleFolder: Path) -> SimulatorPackage:
        checkout = moduleFolder.parent
        isCheckout = (checkout / "pyproject.toml").is_file()
        return cls(moduleFolder / RESOURCES, checkout if isCheckout else None)

    def requirements(self) -> str:
        """Return everything that pip should install, with hashes."""
        if self.checkout is not None:
            return read_text(self.folder / LOCK, LIMIT_BYTES)
        path, digest = self.folder / WHEEL, self.digest()
        if hashlib.sha256(read_bytes(path, LIMIT_BYTES)).hexdigest() != digest:
            raise InputError(
                _("{path} is damaged: reinstall the extension RASTrainer.").format(path=path)
            )
        lock = read_text(self.folder / LOCK, LIMIT_BYTES)
        return f"{lock}rastrainer @ {path.resolve().as_uri()} \\\n    --hash=sha256:{digest}\n"

    def digest(self) -> str:
        """Return the SHA-256 that the wheel must have."""
        with contextlib.suppress(InputError):
            found = DIGEST.fullmatch(read_text(self.folder / f"{WHEEL}.sha256", LIMIT_BYTES))
            if found is not None and found.group(2) == WHEEL:
                return found.group(1)
        raise InputError(
            _("The simulator is missing in {folder}: reinstall the extension RASTrainer.").format(
                folder=self.folder
            )
        )

    def origin(self) -> str:
        """Return what distinguishes this package from others of its version; empty if unknown."""
        with contextlib.suppress(InputError):
            if self.checkout is None:
                return self.digest()
            lock = read_bytes(self.folder / LOCK, LIMIT_BYTES)
            return f"{self.checkout} {hashlib.sha256(lock).hexdigest()}"
        return ""

    def sizesMB(self) -> tuple[int, int] | None:
        """Return the sizes of download and installation on this platform; None if not measured."""
        with contextlib.suppress(InputError, KeyError, TypeError, ValueError):
            measured = read_json(self.folder / SIZES, LIMIT_BYTES)
            entry = measured[f"{sys.platform}-{platform.machine()}"]
            return int(entry["downloadMB"]), int(entry["keptMB"])
        return None


PYTHON_SLICER = "PythonSlicer"


def pythonSlicer(slicerHome: Path) -> Path:
    """Return Slicer's own Python for other programs, from Slicer's folder or the PATH."""
    suffix = ".exe" if sys.platform == "win32" else ""
    inside = slicerHome / "bin" / f"{PYTHON_SLICER}{suffix}"
    found = None if inside.is_file() else shutil.which(PYTHON_SLICER)
    return Path(found) if found else inside


ADDRESS = re.compile(r"https?://[^\s/]\S*")
OPTIONS = (
    # Ignore the user's pip settings and cache: the lock alone counts, and all downloads are removed
    # with the private folder.
    "--isolated",
    "--no-cache-dir",
    "--disable-pip-version-check",
    "--no-input",
    "--progress-bar=off",
    # The lock holds all that is needed, and less than the packages ask for.
    "--no-deps",
    "--require-hashes",
    # Building from sources would run their code by tools that no lock fixes.
    "--only-binary=:all:",
)


def pipArguments(index: str, wheels: Path | None) -> list[str]:
    """Return the options of `pip install`; the hashes of the lock hold for every source.

    `index` is the address of a package index, pip's own where empty; from a folder of `wheels` is
    installed without network.
    """
    if wheels is not None:
        if not any(wheels.glob("*.whl")):
            raise InputError(_("There are no wheels (*.whl) in {path}.").format(path=wheels))
        return [*OPTIONS, "--no-index", "--find-links", str(wheels)]
    if not index:
        return list(OPTIONS)
    if not ADDRESS.fullmatch(index):
        raise InputError(
            _(
                "“{address}” is not the address of a package index: start it with https://, "
                "or leave it empty."
            ).format(address=index)
        )
    return [*OPTIONS, "--index-url", index]


def pipEnvironment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment in which pip finds no settings but its arguments."""
    kept = {name: value for name, value in environment.items() if not name.startswith("PIP_")}
    # Alone, `--isolated` still reads the settings for all users of the computer.
    return {**kept, "PIP_CONFIG_FILE": os.devnull, "PYTHONNOUSERSITE": "1"}
