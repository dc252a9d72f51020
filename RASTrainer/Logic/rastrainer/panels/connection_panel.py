"""The section Simulator: connect, test the connection, and say in words how the link is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import slicer

from rastrainer.slicer.heartbeat import LinkState, LinkStatus
from rastrainer.slicer.link import Link
from rastrainer.slicer.probe import probe
from rastrainer.slicer.translation import _


class ConnectionPanel:
    """Wires the section's widgets to the link.

    Args:
        ui: the widgets of `RASTrainer.ui`.
        link: to the simulator.
    """

    def __init__(self, ui: Any, link: Link) -> None:
        self._ui = ui
        self._link = link
        ui.connectButton.connect("clicked()", self.toggleConnection)
        ui.probeButton.connect("clicked()", self.testConnection)
        link.statusChanged.connect(self._showStatus)
        link.stateChanged.connect(self._showTraining)
        self._showStatus(link.status)

    def close(self) -> None:
        """Listen to the link no more."""
        self._link.statusChanged.disconnect(self._showStatus)
        self._link.stateChanged.disconnect(self._showTraining)

    def toggleConnection(self) -> None:
        """Connect to the simulator, or disconnect."""
        with slicer.util.tryWithErrorDisplay(_("The connection could not be begun.")):
            if self._link.status.state is LinkState.OFF:
                self._link.connectTo(self._ui.hostLineEdit.text, self._ui.portSpinBox.value)
            else:
                self._link.disconnect()

    def testConnection(self) -> None:
        """Look once whether a simulator answers, and say so."""
        with slicer.util.tryWithErrorDisplay(
            _("The connection could not be tested."), waitCursor=True
        ):
            self._showWords(probe(self._ui.hostLineEdit.text, self._ui.portSpinBox.value))

    def _showStatus(self, status: LinkStatus) -> None:
        self._showWords(status)
        isOff = status.state is LinkState.OFF
        ui = self._ui
        ui.connectButton.text = _("Connect") if isOff else _("Disconnect")
        ui.hostLineEdit.enabled = isOff
        ui.portSpinBox.enabled = isOff
        ui.probeButton.enabled = isOff
        ui.probeButton.toolTip = (
            _("Look once whether a simulator answers at this host and port.")
            if isOff
            else _("Disconnect first: the state below tells how the connection is.")
        )
        if status.state is not LinkState.CONNECTED:
            ui.trainingText.text = ""

    def _showWords(self, status: LinkStatus) -> None:
        self._ui.stateText.text = status.sentence
        self._ui.remedyText.text = status.remedy

    def _showTraining(self, state: Mapping[str, Any]) -> None:
        self._ui.trainingText.text = str(state.get("instruction", ""))
