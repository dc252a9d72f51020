"""Start and stop the simulator from Slicer, and connect to it when it is ready."""

from __future__ import annotations

import socket
from collections.abc import Sequence
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.progress import Progress
from rastrainer.protocol import DEFAULT_HOST
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.program.child_process import runChild
from rastrainer.slicer.program.running_simulator import RunningSimulator
from rastrainer.slicer.program.simulator_package import SetupSource
from rastrainer.slicer.program.simulator_program import ProgramState, SimulatorProgram
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from rastrainer.slicer.settings import PROGRAM, Settings
from rastrainer.slicer.translation import _


class SimulatorLogic:
    """Sets up, starts and stops; `process` is to be called about ten times a second.

    Attributes:
        program: the simulator's process.
        setup: the private folder and its pip.
        running: a simulator that was not started from here.
    """

    def __init__(
        self, link: Link, setup: SimulatorSetup, records: Path, settings: Settings
    ) -> None:
        """`records` is the folder into which the simulator writes its journals."""
        self._settings = settings
        self.program = SimulatorProgram()
        self.setup = setup
        self._link = link
        self.running = RunningSimulator(records, link)
        self._records = records
        self.program.ready.connect(self._connect)
        self.program.changed.connect(self._followProgram)

    @property
    def ownProgram(self) -> str:
        """A `rastrainer` that the user has installed elsewhere; "" for the private folder's."""
        return self._settings.get(PROGRAM)

    @property
    def needsSetup(self) -> bool:
        """Whether the simulator has to be set up before it can be started."""
        return not self.ownProgram and not self.setup.isCurrent

    def start(self, port: int, hasWindow: bool = False, hasNetwork: bool = False) -> None:
        """Start the simulator on this computer, or find one that runs already; see `running`.

        Args:
            port: to listen on; 0 takes any free one.
            hasWindow: open the trainee's window on this computer, too.
            hasNetwork: let headsets and browsers of the local network in, by https.

        Raises:
            InputError: it is not set up, or cannot be started.
        """
        if not self.program.isRunning and self.running.look():
            return
        arguments = ["simulator", "--port", str(port), "--records", str(self._records)]
        arguments += ["--lan"] if hasNetwork else []
        arguments += ["--desktop"] if hasWindow else []
        self.program.start(self.command(arguments))

    def command(self, arguments: Sequence[str]) -> list[str]:
        """Return what runs `rastrainer` with arguments such as `simulator --port 0`.

        Raises:
            InputError: it is not set up.
        """
        ownProgram = self.ownProgram
        if ownProgram:
            if not Path(ownProgram).is_file():
                raise InputError(_("There is no program {path}.").format(path=ownProgram))
            return [ownProgram, *arguments]
        if self.needsSetup:
            raise InputError(_("The simulator is not set up yet: press Set up first."))
        return self.setup.command(arguments)

    def run(self, arguments: Sequence[str], progress: Progress, mayFail: bool = False) -> str:
        """Run `rastrainer` to its end and return the last line that it has written.

        Args:
            arguments: such as `scenario pack FOLDER FILE`.
            progress: called while it works: it may let the application draw, and may raise to
                cancel.
            mayFail: whether the line is also returned where it has ended with an error.

        Raises:
            InputError: it is not set up, or has ended with an error and may not.
        """
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

    def startSetup(self, index: str = "", wheels: str = "") -> None:
        """Start setting the simulator up.

        Args:
            index: address of a package index; pip's own where empty.
            wheels: a folder of wheels to install from without network; empty asks the index.

        Raises:
            InputError: it cannot start.
        """
        if self.program.isRunning or self.running.look():
            raise InputError(_("End the simulator that is running before setting it up again."))
        self.setup.begin(SetupSource(index.strip(), Path(wheels) if wheels else None))

    def removeSetup(self) -> None:
        """Remove what was set up; trials and settings stay.

        Raises:
            InputError: the simulator runs, or is being set up, or cannot be removed.
        """
        if self.program.isRunning or self.running.look():
            raise InputError(_("End the simulator that is running before removing it."))
        self.setup.remove()

    def process(self) -> None:
        """Forward the output of pip and the simulator."""
        self.setup.process()
        self.program.process()
        self.running.process()

    def close(self) -> None:
        """End what was started from here: Slicer quits."""
        self.setup.close()
        self.program.close()

    def _connect(self) -> None:
        self._link.connectTo(DEFAULT_HOST, self.program.port)

    def _followProgram(self) -> None:
        if self.program.state is ProgramState.FAILED:
            # One that was started in the meantime may be why.
            self.running.look()


ANY = 0
"""Asks the system for any free port."""


def freePort(preferred: int) -> int:
    """Return the preferred port where nobody listens on it, `ANY` otherwise."""
    try:
        socket.create_server((DEFAULT_HOST, preferred)).close()
    except OSError:
        return ANY
    return preferred
