"""The sources of a set-up: the simulator's wheel, the lock of all other packages, and pip.

Nothing of our own comes from an index: anyone who registered our name there would run code in
hospitals. An installed module has the wheel, known by its SHA-256. In a checkout the sources are
run as they are. What others have made is fixed by the hashes of the lock.
"""

from __future__ import annotations

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
"""Below the module's folder."""
LOCK, SIZES = "requirements.lock", "sizes.json"
WHEEL = f"rastrainer-{__version__}-py3-none-any.whl"
SOURCES = (Path("RASTrainer", "Logic"), Path("RASTrainerSimulatorServer"))
"""In a checkout."""
LIMIT_BYTES = 200 * 2**20
DIGEST = re.compile(r"([0-9a-f]{64})  (\S+)\n")


@dataclass(frozen=True)
class PackageSizes:
    """About what a set-up takes on this platform, in 10⁶ bytes: downloaded, and kept."""

    downloadMB: int
    keptMB: int


@dataclass(frozen=True)
class SimulatorPackage:
    """The simulator as it comes with the module.

    Attributes:
        folder: of the lock, the sizes and the wheel.
        checkout: the repository in which the module lies; None where it was installed.
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
        ours = ""
        if self.checkout is None:
            digest = self.digest()
            ours = f"rastrainer @ {self._wheelAddress(digest)} \\\n    --hash=sha256:{digest}\n"
        return read_text(self.folder / LOCK, LIMIT_BYTES) + ours

    def sourceFolders(self) -> list[Path]:
        """Return the folders whose sources are run in place, none where there is a wheel."""
        return [] if self.checkout is None else [self.checkout / part for part in SOURCES]

    def digest(self) -> str:
        """Return the SHA-256 that the wheel must have."""
        try:
            found = DIGEST.fullmatch(read_text(self.folder / f"{WHEEL}.sha256", LIMIT_BYTES))
        except InputError:
            found = None
        if found is None or found.group(2) != WHEEL:
            raise InputError(
                _(
                    "The simulator is missing in {folder}: reinstall the extension RASTrainer."
                ).format(folder=self.folder)
            )
        return found.group(1)

    def origin(self) -> str:
        """Return what distinguishes this package from another of the same version.

        Empty where it is not known.
        """
        try:
            if self.checkout is None:
                return self.digest()
            lock = read_bytes(self.folder / LOCK, LIMIT_BYTES)
            return f"{self.checkout} {hashlib.sha256(lock).hexdigest()}"
        except InputError:
            return ""

    def sizes(self) -> PackageSizes | None:
        """Return about what a set-up takes on this platform; None where it was not measured."""
        try:
            measured = read_json(self.folder / SIZES, LIMIT_BYTES)
            entry = measured[f"{sys.platform}-{platform.machine()}"]
            return PackageSizes(int(entry["downloadMB"]), int(entry["keptMB"]))
        except (InputError, KeyError, TypeError, ValueError):
            return None

    def _wheelAddress(self, digest: str) -> str:
        path = self.folder / WHEEL
        if hashlib.sha256(read_bytes(path, LIMIT_BYTES)).hexdigest() != digest:
            raise InputError(
                _("{path} is damaged: reinstall the extension RASTrainer.").format(path=path)
            )
        return path.resolve().as_uri()


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
        """Return the options of `pip install`."""
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
                    "“{address}” is not the address of a package index: start it with https://, "
                    "or leave it empty."
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
        """Process a line of pip's output."""
        if BEGUN.match(line):
            self.done = min(self.done + 1, self.count)
        elif line.startswith(LEFT_OUT):
            # Entries for other platforms and other versions of Python.
            self.count -= 1
        elif line.startswith(INSTALLING):
            self.isInstalling = True
