"""Start and stop the simulator from Slicer, and connect to it when it is ready."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST
from rastrainer.slicer.child_process import environmentWith
from rastrainer.slicer.link import Link
from rastrainer.slicer.simulator_program import ProgramState, SimulatorProgram
from rastrainer.slicer.simulator_setup import SetupSource, SimulatorSetup
from rastrainer.slicer.translation import _


class SimulatorDesk:
    """Sets up, starts and stops; `process` is to be called about ten times a second.

    Attributes:
        program: the simulator's process.
        setup: the private folder and its pip.
    """

    def __init__(self, link: Link, setup: SimulatorSetup, records: Path) -> None:
        """`records` is the folder into which the simulator writes its journals."""
        self.program = SimulatorProgram()
        self.setup = setup
        self._link = link
        self._records = records
        self.program.changed.connect(self._followProgram)

    @property
    def needsSetup(self) -> bool:
        """Whether the simulator has to be set up before it can be started."""
        return not self.setup.isCurrent

    def start(
        self,
        port: int,
        ownProgram: str = "",
        hasWindow: bool = False,
        hasNetwork: bool = False,
    ) -> None:
        """Start the simulator on this computer.

        Args:
            port: to listen on; 0 takes any free one.
            ownProgram: a `rastrainer` installed elsewhere; the private folder's where empty.
            hasWindow: open the trainee's window on this computer, too.
            hasNetwork: let headsets and browsers of the local network in, by https.

        Raises:
            InputError: it is not set up, or cannot be started.
        """
        arguments = ["simulator", "--port", str(port), "--records", str(self._records)]
        arguments += ["--lan"] if hasNetwork else []
        arguments += ["--desktop"] if hasWindow else []
        self.program.start(*self.command(arguments, ownProgram))

    def command(
        self, arguments: Sequence[str], ownProgram: str = ""
    ) -> tuple[list[str], dict[str, str] | None]:
        """Return what runs `rastrainer` with these arguments, and the environment for it.

        Args:
            arguments: such as `simulator --port 0`.
            ownProgram: a `rastrainer` installed elsewhere; the private folder's where empty.

        Raises:
            InputError: it is not set up.
        """
        if ownProgram:
            if not Path(ownProgram).is_file():
                raise InputError(_("There is no program {path}.").format(path=ownProgram))
            return [ownProgram, *arguments], None
        if self.needsSetup:
            raise InputError(_("The simulator is not set up yet: press Set up first."))
        return self.setup.command(arguments), environmentWith(self.setup.folder)

    def stop(self) -> None:
        """Disconnect and end the simulator that was started from here."""
        if self.program.isRunning:
            self._link.disconnect()
            self.program.stop()

    def beginSetup(self, package: str, wheels: str = "") -> None:
        """Begin to set the simulator up.

        Args:
            package: what pip installs.
            wheels: a folder of wheels to install from without network; empty asks the network.

        Raises:
            InputError: it cannot begin.
        """
        if self.program.isRunning:
            raise InputError(_("Stop the simulator before it is set up anew."))
        self.setup.begin(SetupSource(package, Path(wheels) if wheels else None))

    def process(self) -> None:
        """Hand on what pip and the simulator say."""
        self.setup.process()
        self.program.process()

    def close(self) -> None:
        """End what was started from here."""
        self.setup.cancel()
        self.program.stop()

    def _followProgram(self) -> None:
        if self.program.state is ProgramState.READY:
            self._link.connectTo(DEFAULT_HOST, self.program.port)
