"""Sets the simulator up in a private folder with Slicer's own Python, once.

Nothing is installed into Slicer: `pip install --target` puts everything into a private folder that
only the simulator's process looks into, and what the simulator never opens is taken out again. A
set-up that was broken off leaves nothing behind, and to remove the simulator is to remove the
folder.
"""

from __future__ import annotations

import contextlib
import json
import re
import shutil
import threading
import uuid
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rastrainer import __version__
from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import make_folder, write_text
from rastrainer.python_environment import private_command
from rastrainer.slicer.program.child_process import ChildProcess, childEnvironment
from rastrainer.slicer.program.simulator_package import (
    SimulatorPackage,
    pipArguments,
    pipEnvironment,
)
from rastrainer.slicer.program.trim_packages import SIZES
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

MARK = "rastrainer-setup.json"
REQUIREMENTS = "rastrainer-requirements.txt"
CHECKOUT = "rastrainer-checkout.pth"
SOURCES = ("RASTrainer/Logic", "RASTrainerSimulatorServer")
"""Sources of a checkout, run in place."""
MARK_LIMIT_BYTES = 4096
PROGRAM, TRIMMER = "rastrainer_simulator.cli.main", "rastrainer.slicer.program.trim_packages"
REMOVED = ".removed-"
"""In the name of a folder that is being removed."""
ENTRY = re.compile(r"^[a-z0-9][A-Za-z0-9._-]* ?(?:==|@)", re.MULTILINE)
BEGUN = re.compile(r"(?:Collecting|Processing) \S")
LEFT_OUT, INSTALLING = "Ignoring ", "Installing collected packages"


class SimulatorSetup:
    """The private folder and the pip that fills it; call `process` now and then.

    pip has `fetched` so many of `count` packages, or is fetching the last of them. `isInstalling`
    says that all are there and are being put into the folder; `isCanceled`, that the set-up that
    runs, or ran last, was canceled. `progressed` emits each line that pip writes, `finished` an
    error message, empty on success, and `changed` nothing, whenever a set-up begins or ends, or the
    simulator is removed.
    """

    def __init__(self, python: Path, folder: Path, package: SimulatorPackage) -> None:
        self.folder = folder
        self.package = package
        self.fetched = self.count = 0
        self.isInstalling = self.isCanceled = False
        self.progressed = Signal()
        self.changed = Signal()
        self.finished = Signal()
        self._python = python
        self._partial = folder.with_name(folder.name + ".partial")
        self._child: ChildProcess | None = None
        self._isTrimming = False

    @property
    def isRunning(self) -> bool:
        return self._child is not None

    @property
    def installedVersion(self) -> str:
        """The version that is set up; empty if none is."""
        return str(self._read(MARK).get("version", ""))

    @property
    def isCurrent(self) -> bool:
        mark = self._read(MARK)
        return (mark.get("version"), mark.get("origin")) == (__version__, self.package.origin())

    @property
    def installedMB(self) -> int | None:
        """Size of the private folder in 10⁶ bytes; None if unknown."""
        kept = self._read(SIZES).get("keptBytes")
        return kept // 10**6 if isinstance(kept, int) else None

    def begin(self, index: str = "", wheels: Path | None = None) -> None:
        """Start the set-up, which replaces an earlier one; for the arguments see `pipArguments`."""
        if self.isRunning:
            raise InputError(_("The simulator is already being set up."))
        words = ["-m", "pip", "install", *pipArguments(index, wheels)]
        requirements = self.package.requirements()
        discard(self._partial)
        make_folder(self._partial)
        write_text(self._partial / REQUIREMENTS, requirements)
        checkout = self.package.checkout
        if checkout is not None:
            sources = "".join(f"{checkout / part}\n" for part in SOURCES)
            write_text(self._partial / CHECKOUT, sources)
        words += ["--target", str(self._partial), "-r", str(self._partial / REQUIREMENTS)]
        self.fetched, self.count = 0, len(ENTRY.findall(requirements))
        self.isInstalling = self.isCanceled = self._isTrimming = False
        self._child = ChildProcess([self._python, *words], pipEnvironment(childEnvironment()))
        self.changed.emit()

    def cancel(self) -> None:
        if self._child is not None:
            self.isCanceled = True
            self._child.end()
            self.changed.emit()

    def remove(self) -> None:
        if self.isRunning:
            raise InputError(_("Cancel the set-up first."))
        discard(self.folder)
        self.changed.emit()

    def process(self) -> None:
        if self._child is None:
            return
        child, isOver = self._child, self._child.poll()
        for line in child.takeLines():
            if BEGUN.match(line):
                self.fetched = min(self.fetched + 1, self.count)
            elif line.startswith(LEFT_OUT):
                # Entries for other platforms and other versions of Python.
                self.count -= 1
            elif line.startswith(INSTALLING):
                self.isInstalling = True
            self.progressed.emit(line)
        if not isOver:
            return
        self._child, status = None, child.process.poll()
        if status == 0 and not self._isTrimming and not self.isCanceled:
            self._isTrimming = True
            words = private_command(self._python, self._partial, TRIMMER, str(self._partial))
            self._child = ChildProcess(words)
            return
        error = self._finish(status)
        self.changed.emit()
        self.finished.emit(error)

    def close(self) -> None:
        if self._child is not None:
            self._child.close()
            self._child = None
            self._dropPartial()

    def command(self, arguments: Sequence[str]) -> list[str]:
        return private_command(self._python, self.folder, PROGRAM, *arguments)

    def _read(self, name: str) -> dict[str, Any]:
        """Return the content of a JSON file in the private folder; empty if it is damaged."""
        with contextlib.suppress(InputError):
            values = read_json(self.folder / name, MARK_LIMIT_BYTES)
            if isinstance(values, dict):
                return values
        return {}

    def _dropPartial(self) -> None:
        # What cannot be removed now is, before the next set-up.
        with contextlib.suppress(InputError):
            discard(self._partial)

    def _finish(self, status: int | None) -> str:
        """Put the new folder in place, and return an error message, empty on success."""
        if self.isCanceled or status != 0:
            self._dropPartial()
        if self.isCanceled:
            return _("The set-up was canceled.")
        if self._isTrimming and status != 0:
            return _(
                "What was installed cannot be run (status {status}); the last lines say why."
            ).format(status=status)
        if status != 0:
            return _(
                "The installation ended with status {status}; its last lines say why. Behind a "
                "firewall, choose a folder of wheels or your own package index."
            ).format(status=status)
        mark = {"version": __version__, "origin": self.package.origin()}
        try:
            write_text(self._partial / MARK, json.dumps(mark) + "\n")
            discard(self.folder)
            self._partial.replace(self.folder)
        except (InputError, OSError) as error:
            return _("The folder {path} cannot be replaced: {error}").format(
                path=self.folder, error=error
            )
        return ""


def discard(folder: Path) -> None:
    """Remove a folder: at once from its place, and soon from the disk; none is no error.

    What an earlier removal has left goes, too: Slicer may have quit meanwhile.
    """
    if folder.exists():
        try:
            folder.rename(folder.with_name(f"{folder.name}{REMOVED}{uuid.uuid4().hex}"))
        except OSError as error:
            raise InputError(
                _("The folder {path} cannot be removed: {reason}.").format(
                    path=folder, reason=error.strerror
                )
            ) from None
    aside = list(folder.parent.glob(f"{folder.name}*{REMOVED}*"))

    def remove() -> None:
        for path in aside:
            shutil.rmtree(path, ignore_errors=True)

    threading.Thread(target=remove, daemon=True).start()
