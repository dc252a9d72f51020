"""Above the section Simulator: one that runs already, to connect to or to end."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.panels.widgets import setText, setUsable
from rastrainer.slicer.session import Session
from rastrainer.slicer.translation import _


class RunningSimulatorPanel:
    """Wires its widgets to the session; seen only where a simulator was found."""

    def __init__(self, ui: Any, session: Session) -> None:
        self._ui = ui
        self._running = session.simulator.running
        ui.connectToRunningButton.connect("clicked()", self.connectToIt)
        ui.endRunningButton.connect("clicked()", self.endIt)
        self._running.changed.connect(self._show)
        self._running.look()
        self._show()

    def close(self) -> None:
        """Listen to the session no more."""
        self._running.changed.disconnect(self._show)

    def connectToIt(self) -> None:
        """Connect to the simulator that runs already."""
        with slicer.util.tryWithErrorDisplay(_("The connection could not be begun.")):
            self._running.connect()

    def endIt(self) -> None:
        """End the simulator that runs already."""
        with slicer.util.tryWithErrorDisplay(_("The simulator could not be ended.")):
            self._running.end()

    def _show(self) -> None:
        ui, running = self._ui, self._running
        ui.runningSimulatorFrame.visible = running.holder is not None
        setText(ui.runningSimulatorText, running.sentence)
        setUsable(
            ui.connectToRunningButton,
            running.canConnect,
            _("Go on with this simulator, and with the trial that may be under way in it."),
            _("It does not say where it listens."),
        )
        setUsable(
            ui.endRunningButton,
            running.canEnd,
            _("End this simulator and its window. A trial under way can be resumed afterward."),
            _("It is ending, or does not say who it is."),
        )
