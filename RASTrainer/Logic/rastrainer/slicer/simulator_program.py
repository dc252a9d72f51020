"""The simulator's process, as far as Slicer has started it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from enum import Enum

from rastrainer.slicer.child_process import ChildProcess
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

_READY = re.compile(r"RASTrainer simulator ready on (\S+):(\d+)$")


class ProgramState(str, Enum):
    """Where the simulator's process stands."""

    STOPPED = "stopped"
    STARTING = "starting"
    READY = "ready"
    FAILED = "failed"


class SimulatorProgram:
    """Starts and stops `rastrainer simulator`; `process` is to be called now and then.

    Attributes:
        state: where the process stands.
        port: on which it listens, once it is ready.
        sentence: what happened last, for people.
        changed: emits nothing, whenever `state` has changed.
        wroteLine: emits each line of its output.
    """

    def __init__(self) -> None:
        self.state = ProgramState.STOPPED
        self.port = 0
        self.sentence = _("No simulator was started from here.")
        self.changed = Signal()
        self.wroteLine = Signal()
        self._child: ChildProcess | None = None
        self._lastLine = ""

    @property
    def isRunning(self) -> bool:
        """Whether the process is there."""
        return self._child is not None

    def start(self, command: Sequence[str], environment: Mapping[str, str] | None = None) -> None:
        """Start the process; a second time does nothing while it runs.

        Raises:
            InputError: the program cannot be started.
        """
        if self._child is not None:
            return
        self._child = ChildProcess(command, environment)
        self._lastLine = ""
        self._change(ProgramState.STARTING, _("The simulator is starting."))

    def stop(self) -> None:
        """End the process; trials it has recorded stay with it and are offered next time."""
        if self._child is None:
            return
        self._child.stop()
        self._handOnLines()
        self._child = None
        self._change(ProgramState.STOPPED, _("The simulator was stopped."))

    def process(self) -> None:
        """Hand on its output, and notice that it is ready or has ended."""
        if self._child is None:
            return
        status = self._child.exitStatus
        self._handOnLines()
        if status is None:
            return
        self._child = None
        if status == 0:
            # As when the trainee's window is closed.
            self._change(ProgramState.STOPPED, _("The simulator has ended."))
            return
        reason = self._lastLine or _("it said nothing")
        self._change(
            ProgramState.FAILED,
            _("The simulator ended by itself (status {status}): {reason}").format(
                status=status, reason=reason
            ),
        )

    def _handOnLines(self) -> None:
        for line in self._child.takeLines():
            self._lastLine = line or self._lastLine
            self.wroteLine.emit(line)
            ready = _READY.match(line)
            if ready:
                self.port = int(ready.group(2))
                self._change(
                    ProgramState.READY,
                    _("The simulator runs on port {port}.").format(port=self.port),
                )

    def _change(self, state: ProgramState, sentence: str) -> None:
        self.state, self.sentence = state, sentence
        self.changed.emit()
