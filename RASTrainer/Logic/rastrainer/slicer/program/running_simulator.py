"""A simulator that was not started from here, and keeps another from recording: found, and ended.

Such as one that a crash of Slicer has left behind, with the trial that was under way.
"""

from __future__ import annotations

import contextlib
import time
from datetime import datetime
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.folder import FolderHolder, read_holder
from rastrainer.protocol import DEFAULT_HOST
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.program.child_process import KILL_AFTER_S, SLICER, endProcess
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

LOOK_EVERY_S = 1.0
_ANY_ADDRESS = ("0.0.0.0", "::", "localhost", "")


class RunningSimulator:
    """Looks who records in the folder; `process` is to be called about ten times a second.

    Attributes:
        holder: the simulator that does; None where there is none.
        isEnding: whether it was asked to end.
        changed: emits nothing, whenever one of them has changed.
    """

    def __init__(self, records: Path, link: Link) -> None:
        """`records` is the folder of the journals."""
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
        """What was found, for people; empty where nothing was."""
        if self.holder is None:
            return ""
        if self.isEnding:
            return _("The simulator that was running already is ending.")
        return _(
            "A simulator that was not started from here is running on this computer{since}. "
            "Connect to it, or end it before another is started: recorded trials stay."
        ).format(since=_since(self.holder.started))

    @property
    def canConnect(self) -> bool:
        """Whether it says where it listens."""
        return self.holder is not None and self.holder.port > 0 and not self.isEnding

    @property
    def canEnd(self) -> bool:
        """Whether it says who it is."""
        return self.holder is not None and self.holder.pid > 0 and not self.isEnding

    def look(self) -> bool:
        """Look at once, and return whether there is one."""
        self._lookAt = time.monotonic() + LOOK_EVERY_S
        found = read_holder(self._records)
        if found != self.holder:
            self.isEnding = self.isEnding and _isSame(found, self.holder)
            self.holder = found
            self.changed.emit()
        return found is not None

    def connect(self) -> None:
        """Connect to it.

        Raises:
            InputError: it has ended, or listens nowhere.
        """
        self.look()
        holder = self.holder
        if holder is None or not self.canConnect:
            raise InputError(_("There is no longer a simulator to connect to."))
        host = DEFAULT_HOST if holder.host in _ANY_ADDRESS else holder.host
        self._link.connectTo(host, holder.port)
        self._connected = holder

    def end(self) -> None:
        """Ask it to end, with its window; `process` notices that, and kills it if need be.

        Raises:
            InputError: another user of this computer has started it.
        """
        shown = self.holder
        self.look()
        # Another that has begun since was not what was to be ended.
        if self.holder is None or not self.canEnd or not _isSame(self.holder, shown):
            return
        _signal(self.holder, isAsked=True)
        if _isSame(self._connected, self.holder):
            self._link.disconnect()
        self.isEnding = True
        self._lookAt, self._killAt = 0.0, time.monotonic() + KILL_AFTER_S
        self.changed.emit()

    def process(self) -> None:
        """Look whether what was found is there still."""
        if self.holder is None or time.monotonic() < self._lookAt:
            return
        self.look()
        if self.isEnding and self.holder is not None:
            self._lookAt = 0.0
            if time.monotonic() > self._killAt:
                with contextlib.suppress(InputError):
                    _signal(self.holder, isAsked=False)


def _signal(holder: FolderHolder, isAsked: bool) -> None:
    """Signal the process that holds the folder at this moment: its number is nobody else's."""
    try:
        endProcess(holder.pid, holder.started_by == SLICER, isAsked)
    except PermissionError:
        raise InputError(
            _("This simulator was started by another user of this computer, who can end it.")
        ) from None


def _isSame(one: FolderHolder | None, other: FolderHolder | None) -> bool:
    """Return whether they are the same process, wherever it listens by now."""
    if one is None or other is None:
        return False
    return (one.pid, one.started) == (other.pid, other.started)


def _since(started: str) -> str:
    """Return since when, in local time."""
    with contextlib.suppress(ValueError):
        moment = datetime.fromisoformat(started).astimezone()
        return _(" since {moment}").format(moment=moment.strftime("%Y-%m-%d %H:%M"))
    return ""
