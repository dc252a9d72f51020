"""Sets the simulator up in a folder of its own, by Slicer's own Python, once.

Nothing is installed into Slicer: `pip install --target` puts everything into a private folder that
only the simulator's process looks into. A set-up that was broken off leaves nothing behind.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rastrainer import __version__
from rastrainer.errors import InputError
from rastrainer.files import read_json, write_text
from rastrainer.slicer.child_process import ChildProcess
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

MARK = "rastrainer-setup.json"
MARK_LIMIT_BYTES = 4096
START = "import sys; sys.path.insert(0, sys.argv.pop(1)); from rastrainer_simulator.cli import main"
"""The folder first, whatever Slicer's launcher puts into PYTHONPATH."""


@dataclass(frozen=True)
class SetupSource:
    """Where the simulator's packages come from.

    Attributes:
        package: what pip installs: a requirement, or the folder of a checkout.
        wheels: a folder of wheels to install from without network; None asks the package index.
    """

    package: str
    wheels: Path | None = None

    def pipArguments(self) -> list[str]:
        """Return what follows `pip install`.

        Raises:
            InputError: the folder of wheels holds none.
        """
        if self.wheels is None:
            return [self.package]
        if not any(self.wheels.glob("*.whl")):
            raise InputError(_("There are no wheels (*.whl) in {path}.").format(path=self.wheels))
        return ["--no-index", "--find-links", str(self.wheels), self.package]


class SimulatorSetup:
    """The private folder and the pip that fills it; `process` is to be called now and then.

    Attributes:
        folder: of the installed simulator.
        progressed: emits each line that pip writes.
        finished: emits an error's sentence, empty where the simulator is set up.
    """

    def __init__(self, python: Path, folder: Path) -> None:
        self.folder = folder
        self.progressed = Signal()
        self.finished = Signal()
        self._python = python
        self._partial = folder.with_name(folder.name + ".partial")
        self._child: ChildProcess | None = None

    @property
    def isRunning(self) -> bool:
        """Whether pip is at work."""
        return self._child is not None

    @property
    def installedVersion(self) -> str:
        """The version that is set up, empty where none is."""
        try:
            mark = read_json(self.folder / MARK, MARK_LIMIT_BYTES)
            return str(mark["version"])
        except (InputError, KeyError, TypeError):
            return ""

    @property
    def isCurrent(self) -> bool:
        """Whether the simulator of this module's version is set up."""
        return self.installedVersion == __version__

    def begin(self, source: SetupSource) -> None:
        """Begin to set up, in place of what is there.

        Raises:
            InputError: there are no wheels, or the folder or pip cannot be used.
        """
        if self.isRunning:
            raise InputError(_("The simulator is being set up already."))
        words = source.pipArguments()
        try:
            shutil.rmtree(self._partial, ignore_errors=True)
            self._partial.mkdir(parents=True)
        except OSError as error:
            raise InputError(
                _("The folder {path} cannot be made: {reason}.").format(
                    path=self._partial, reason=error.strerror
                )
            ) from None
        options = ["--disable-pip-version-check", "--no-input", "--progress-bar", "off"]
        target = ["--target", str(self._partial)]
        self._child = ChildProcess(
            [self._python, "-m", "pip", "install", *options, *target, *words]
        )

    def cancel(self) -> None:
        """Break the set-up off; what was set up before stays."""
        if self._child is None:
            return
        self._child.stop()
        self._child = None
        shutil.rmtree(self._partial, ignore_errors=True)
        self.finished.emit(_("The set-up was canceled."))

    def process(self) -> None:
        """Hand on what pip says, and finish when it has ended."""
        if self._child is None:
            return
        status = self._child.exitStatus
        for line in self._child.takeLines():
            self.progressed.emit(line)
        if status is None:
            return
        self._child = None
        self.finished.emit(self._finish(status))

    def command(self, arguments: Sequence[str]) -> list[str]:
        """Return what starts the installed `rastrainer` with these arguments."""
        code = f"{START}; sys.exit(main())"
        return [str(self._python), "-c", code, str(self.folder), *arguments]

    def _finish(self, status: int) -> str:
        if status != 0:
            shutil.rmtree(self._partial, ignore_errors=True)
            return _(
                "pip ended with status {status}; its last lines say why. Behind a firewall, choose "
                "a folder of wheels."
            ).format(status=status)
        mark = {"version": __version__}
        try:
            write_text(self._partial / MARK, json.dumps(mark) + "\n")
            shutil.rmtree(self.folder, ignore_errors=True)
            self._partial.replace(self.folder)
        except (InputError, OSError) as error:
            return _("The folder {path} cannot be replaced: {error}").format(
                path=self.folder, error=error
            )
        return ""
