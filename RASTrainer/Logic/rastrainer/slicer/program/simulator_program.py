"""The simulator's process, as far as Slicer has started it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from enum import Enum

from rastrainer.errors import InputError
from rastrainer.slicer.program.child_process import ChildProcess
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

_READY = re.compile(r"RASTrainer simulator ready on (\S+):(\d+)$")
_VIEWS = re.compile(r"RASTrainer simulator serves views on (\S+), pairing code (\d+)$")
_NETWORK = re.compile(
    r"RASTrainer simulator serves the local network on (.+); the browser warns"
    r"(?:.* fingerprint, (\S+))?$"
)
_KINEMATICS = re.compile(r"RASTrainer simulator computes the robot's kinematics by (.+)$")
_LAUNCHER_CRASH = re.compile(r"error: \[.*\] exit abnormally")
"""Message of the launcher of Slicer's Python after the real Python was killed."""
_NEW_CODE = re.compile(r"RASTrainer simulator has a new pairing code for views: (\d+)$")


class ProgramState(str, Enum):
    """State of the simulator's process."""

    STOPPED = "stopped"
    STARTING = "starting"
    READY = "ready"
    STOPPING = "stopping"
    FAILED = "failed"


class SimulatorProgram:
    """Starts and stops `rastrainer simulator`; call `process` now and then.

    A browser or a headset finds its page at `pageAddresses`, and is admitted by `pairingCode`,
    which only the program that started it knows; `fingerprint` is the SHA-256 of the certificate of
    the pages in the local network, empty without. `wroteLine` emits each line of its output,
    `changed` nothing, whenever a state, a sentence, an address or the code has changed.
    """

    def __init__(self) -> None:
        self.state = ProgramState.STOPPED
        self.port = 0
        self.sentence = _("No simulator was started from here.")
        self.pageAddresses: list[str] = []
        self.fingerprint = ""
        self.pairingCode = ""
        self.ready = Signal()
        self.changed = Signal()
        self.wroteLine = Signal()
        self._child: ChildProcess | None = None
        self._lastLine = ""
        self._isAskedToEnd = False
        self._next: list[str] | None = None

    @property
    def isRunning(self) -> bool:
        return self._child is not None

    @property
    def pairingSentence(self) -> str:
        """How a browser or a headset is paired; empty while there is nothing to pair with."""
        if not (self.isRunning and self.pairingCode):
            return ""
        sentence = _(
            "In a browser or a headset open {addresses} and enter the code {code}."
        ).format(addresses=_(" or ").join(self.pageAddresses), code=self.pairingCode)
        if not self.fingerprint:
            return sentence
        warning = _(
            "The browser warns about a certificate made here; its SHA-256 fingerprint is "
            "{fingerprint}."
        ).format(fingerprint=self.fingerprint)
        return f"{sentence} {warning}"

    def start(self, command: Sequence[str]) -> None:
        """Start the process: soon, where the former one is ending; while it runs, do nothing."""
        if self.state is ProgramState.STOPPING:
            self._next = list(command)
            self._change(
                ProgramState.STOPPING, _("The simulator is ending; it will then be started again.")
            )
        if self._child is not None:
            return
        self._child = ChildProcess(command)
        self._lastLine = ""
        self._isAskedToEnd = False
        self._change(ProgramState.STARTING, _("The simulator is starting."))

    def stop(self) -> None:
        """Ask the process to end; trials it has recorded stay with it and are offered next time.

        `process` notices the end, and kills what does not end within seconds.
        """
        self._next = None
        if self._child is None:
            return
        self._isAskedToEnd = True
        self._child.end()
        self._change(ProgramState.STOPPING, _("The simulator is ending."))

    def process(self) -> None:
        if self._child is None:
            return
        isOver, child = self._child.poll(), self._child
        self._forwardLines(child)
        if isOver:
            self._child = None
            self._change(*self._ended(child.process.poll()))
            command, self._next = self._next, None
            try:
                if command is not None:
                    self.start(command)
            except InputError as error:
                self._change(ProgramState.FAILED, str(error))
        elif child.process.poll() is not None and self.state is not ProgramState.STOPPING:
            # Its window, or the real Python of a launcher that was killed.
            self._change(ProgramState.STOPPING, _("The simulator is ending."))

    def close(self) -> None:
        self._next = None
        if self._child is not None:
            self._child.close()
            self._forwardLines(self._child)
            self._child = None
            self._change(ProgramState.STOPPED, _("The simulator was stopped."))

    def _ended(self, status: int | None) -> tuple[ProgramState, str]:
        if self._isAskedToEnd:
            return ProgramState.STOPPED, _("The simulator was stopped.")
        if status == 0:
            # For example because the trainee's window was closed.
            return ProgramState.STOPPED, _("The simulator has ended.")
        if status is None or status < 0 or _LAUNCHER_CRASH.match(self._lastLine):
            return ProgramState.FAILED, _(
                "The simulator stopped unexpectedly: it crashed, or was ended from outside, "
                "for example by the task manager or for lack of memory. What it has recorded "
                "is kept: start it again to continue."
            )
        reason = self._lastLine or _("it wrote nothing")
        sentence = _("The simulator ended by itself (status {status}): {reason}")
        return ProgramState.FAILED, sentence.format(status=status, reason=reason)

    def _forwardLines(self, child: ChildProcess) -> None:
        for line in child.takeLines():
            self._lastLine = line or self._lastLine
            self.wroteLine.emit(line)
            # A program that is ending may still report that it is ready.
            if self.state is not ProgramState.STOPPING:
                self._read(line)

    def _read(self, line: str) -> None:
        if ready := _READY.match(line):
            self.port = int(ready.group(2))
            sentence = _("The simulator runs on port {port}.").format(port=self.port)
            self._change(ProgramState.READY, sentence)
            self.ready.emit()
        elif kinematics := _KINEMATICS.match(line):
            sentence = _(
                "The simulator runs on port {port}. {name} computes the robot's kinematics."
            ).format(port=self.port, name=kinematics.group(1))
            self._change(ProgramState.READY, sentence)
        elif views := _VIEWS.match(line):
            self.fingerprint = ""
            self._pair([views.group(1)], views.group(2))
        elif network := _NETWORK.match(line):
            self.fingerprint = network.group(2) or ""
            self._pair([*self.pageAddresses, *network.group(1).split(" or ")], self.pairingCode)
        elif code := _NEW_CODE.match(line):
            self._pair(self.pageAddresses, code.group(1))

    def _pair(self, addresses: list[str], code: str) -> None:
        self.pageAddresses, self.pairingCode = addresses, code
        self.changed.emit()

    def _change(self, state: ProgramState, sentence: str) -> None:
        self.state, self.sentence = state, sentence
        if state is not ProgramState.READY:
            self.pageAddresses, self.pairingCode = [], ""
        self.changed.emit()
