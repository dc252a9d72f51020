"""What the module brings along to set the simulator up: its wheel, and a lock of all others.

Nothing of our own comes from an index: whoever registered our name there would run code in
hospitals. An installed module has the wheel, known by its SHA-256. In a checkout the sources are
run as they are. What others have made is fixed by the hashes of the lock.
"""

from __future__ import annotations

import hashlib
import platform
import re
import sys
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
        """Return the package of a module that lies in this folder."""
        checkout = moduleFolder.parent
        isCheckout = (checkout / "pyproject.toml").is_file()
        return cls(moduleFolder / RESOURCES, checkout if isCheckout else None)

    def requirements(self) -> str:
        """Return all that pip is to install, with hashes.

        Raises:
            InputError: the lock or the wheel is missing, or the wheel is damaged.
        """
        ours = ""
        if self.checkout is None:
            digest = self.digest()
            ours = f"rastrainer @ {self._wheelAddress(digest)} \\\n    --hash=sha256:{digest}\n"
        return read_text(self.folder / LOCK, LIMIT_BYTES) + ours

    def sourceFolders(self) -> list[Path]:
        """Return the folders whose sources are run in place, none where there is a wheel."""
        return [] if self.checkout is None else [self.checkout / part for part in SOURCES]

    def digest(self) -> str:
        """Return the SHA-256 that the wheel must have.

        Raises:
            InputError: it is missing.
        """
        try:
            found = DIGEST.fullmatch(read_text(self.folder / f"{WHEEL}.sha256", LIMIT_BYTES))
        except InputError:
            found = None
        if found is None or found.group(2) != WHEEL:
            raise InputError(
                _(
                    "The simulator is missing in {folder}: install the extension RASTrainer anew."
                ).format(folder=self.folder)
            )
        return found.group(1)

    def origin(self) -> str:
        """Return what tells this package from another's of the same version.

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
                _("{path} is damaged: install the extension RASTrainer anew.").format(path=path)
            )
        return path.resolve().as_uri()
