"""Start and stop the simulator from Slicer, connect to it, and find a running simulator.

A crash of Slicer may have left one behind, with the trial that was running; it keeps another
simulator from recording.
"""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.folder import FolderHolder, read_holder
from rastrainer.protocol import DEFAULT_HOST
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.program.child_process import KILL_AFTER_S, SLICER, endProcess, runChild
from rastrainer.slicer.program.simulator_program import ProgramState, SimulatorProgram
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from rastrainer.slicer.settings import PROGRAM, Settings
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress

LOOK_EVERY_S = 1.0
_ANY_ADDRESS = ("0.0.0.0", "::", "localhost", "")


class RunningSimulator:
    """Finds the simulator that records in the folder of the journals, its `holder`.

    `isEnding` says whether it was asked to end; `changed` emits nothing when one of them changes.
    """

    def __init__(self, records: Path, link: Link) -> None:
        self.holder: FolderHolder | None = None
        self.isEnding = False
        self.changed = Signal()
        self._records = records
        self._link = link
        self._connected: FolderHolder | None = None
        self._lookAt = 0.0
        self._killAt = 0.0

    @property
    def sentence(self) -> str:
        """The simulator found, in words; empty if none was."""
        if self.holder is None:
            return ""
        if self.isEnding:
            return _("The simulator that was already running is ending.")
        since = ""
        with contextlib.suppress(ValueError):
            moment = datetime.fromisoformat(self.holder.started).astimezone()
            since = _(" since {moment}").format(moment=moment.strftime("%Y-%m-%d %H:%M"))
        return _(
            "A simulator that was not started from here is running on this computer{since}. "
            "Connect to it, or end it before another is started: recorded trials stay."
        ).format(since=since)

    @property
    def canConnect(self) -> bool:
        return self.holder is not None and self.holder.port > 0 and not self.isEnding

    @property
    def canEnd(self) -> bool:
        return self.holder is not None and self.holder.pid > 0 and not self.isEnding

    def look(self) -> bool:
        """Check now, and return whether there is one."""
        self._lookAt = time.monotonic() + LOOK_EVERY_S
        found = read_holder(self._records)
        if found != self.holder:
            self.isEnding = self.isEnding and _process(found) == _process(self.holder)
            self.holder = found
            self.changed.emit()
        return found is not None

    def connect(self) -> None:
        self.look()
        holder = self.holder
        if holder is None or not self.canConnect:
            raise InputError(_("There is no longer a simulator to connect to."))
        host = DEFAULT_HOST if holder.host in _ANY_ADDRESS else holder.host
        self._link.connectTo(host, holder.port)
        self._connected = holder

    def end(self) -> None:
        """Ask it to end, with its window; `process` notices the end, and kills it if needed."""
        shown = _process(self.holder)
        self.look()
        # A simulator that has started since must not be ended.
        if self.canEnd and _process(self.holder) == shown:
            self._signal(isAsked=True)
            if _process(self._connected) == shown:
                self._link.disconnect()
            self.isEnding = True
            self._lookAt, self._killAt = 0.0, time.monotonic() + KILL_AFTER_S
            self.changed.emit()

    def process(self) -> None:
        if self.holder is None or time.monotonic() < self._lookAt:
            return
        self.look()
        if self.isEnding and self.holder is not None:
            self._lookAt = 0.0
            if time.monotonic() > self._killAt:
                with contextlib.suppress(InputError):
                    self._signal(isAsked=False)

    def _signal(self, isAsked: bool) -> None:
        """Signal the process that holds the folder now: no other process can have its number."""
        assert self.holder is not None
        try:
            endProcess(self.holder.pid, self.holder.started_by == SLICER, isAsked)
        except PermissionError:
            raise InputError(
                _("This simulator was started by another user of this computer, who can end it.")
            ) from None


def _process(holder: FolderHolder | None) -> tuple[int, str] | None:
    """Return what distinguishes a process from others, wherever it listens now."""
    return None if holder is None else (holder.pid, holder.started)


class SimulatorLogic:
    """Sets up, starts and stops the simulator; call `process` once a second, or more often."""

    def __init__(
        self, link: Link, setup: SimulatorSetup, records: Path, settings: Settings
    ) -> None:
        self._settings = settings
        self.program = SimulatorProgram()
        self.setup = setup
        self._link = link
        self.running = RunningSimulator(records, link)
        self._records = records
        self.program.ready.connect(lambda: link.connectTo(DEFAULT_HOST, self.program.port))
        # A simulator started in the meantime may be why this one has failed.
        self.program.changed.connect(
            lambda: self.program.state is ProgramState.FAILED and self.running.look()
        )

    @property
    def needsSetup(self) -> bool:
        """Whether the simulator has to be set up before it can be started."""
        return not self._settings.get(PROGRAM) and not self.setup.isCurrent

    @property
    def isChanging(self) -> bool:
        """Whether something is being set up, started or ended, and says how far it is."""
        isInBetween = self.program.state in (ProgramState.STARTING, ProgramState.STOPPING)
        return self.setup.isRunning or isInBetween or self.running.isEnding

    def start(self, port: int, hasWindow: bool = False, hasNetwork: bool = False) -> None:
        """Start the simulator, on any port if the given one is in use, or find a running one."""
        if not self.program.isRunning and self.running.look():
            return
        arguments = ["simulator", "--port", str(freePort(port)), "--records", str(self._records)]
        arguments += ["--lan"] if hasNetwork else []
        arguments += ["--desktop"] if hasWindow else []
        self.program.start(self.command(arguments))

    def command(self, arguments: Sequence[str]) -> list[str]:
        """Return what runs `rastrainer` with arguments such as `simulator --port 0`."""
        # A `rastrainer` that the user has installed elsewhere; "" for the private folder's.
        ownProgram = self._settings.get(PROGRAM)
        if ownProgram:
            if not Path(ownProgram).is_file():
                raise InputError(_("There is no program {path}.").format(path=ownProgram))
            return [ownProgram, *arguments]
        if self.needsSetup:
            raise InputError(_("The simulator is not set up yet: press Set up first."))
        return self.setup.command(arguments)

    def run(self, arguments: Sequence[str], progress: Progress, mayFail: bool = False) -> str:
        """Return the last line that `rastrainer` writes, by `mayFail` also after an error."""
        ended = runChild(self.command(arguments), progress)
        sentence = ended.lastLine.removeprefix("rastrainer: ")
        sentence = sentence or _("The simulator's program wrote nothing.")
        if ended.exitStatus != 0 and not mayFail:
            raise InputError(sentence)
        return sentence

    def stop(self) -> None:
        """Disconnect, and ask the simulator that was started from here to end."""
        if self.program.isRunning:
            self._link.disconnect()
            self.program.stop()

    def startSetup(self, index: str, wheels: str) -> None:
        """Start the set-up, from a source of `pipArguments`."""
        if self.program.isRunning or self.running.look():
            raise InputError(_("End the simulator that is running before setting it up again."))
        self.setup.begin(index.strip(), Path(wheels) if wheels else None)

    def removeSetup(self) -> None:
        """Remove the installed simulator; trials and settings stay."""
        if self.program.isRunning or self.running.look():
            raise InputError(_("End the simulator that is running before removing it."))
        self.setup.remove()

    def process(self) -> None:
        self.setup.process()
        self.program.process()
        self.running.process()

    def close(self) -> None:
        """End all processes started from here: Slicer quits."""
        self.setup.close()
        self.program.close()


def freePort(preferred: int) -> int:
    """Return the preferred port; 0, for any free one, if a program listens on it."""
    try:
        socket.create_server((DEFAULT_HOST, preferred)).close()
    except OSError:
        return 0
    return preferred
