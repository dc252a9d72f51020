"""The menu of a procedure's phase: what leads to the next one. The trial goes on meanwhile."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer.protocol import CommandName, Phase
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.net.views.screen import Menu, MenuItem

STAND_OFF_MM = 30.0
"""Of the guide's tip before the entry where the robot aligns it: near, and clear of the skin."""
_COMMANDS: Mapping[str, str] = {
    "accept": CommandName.ACCEPT_REGISTRATION,
    "again": CommandName.REGISTER_AGAIN,
    "lock": CommandName.LOCK_GUIDE,
    "align": CommandName.ALIGN_GUIDE,
    "insert": CommandName.START_INSERTION,
    "retract": CommandName.RETRACT_DRILL,
    "release": CommandName.RELEASE_INSTRUMENT,
}
_ITEMS: Mapping[Phase, tuple[str, ...]] = {
    Phase.VERIFYING: ("accept", "again"),
    Phase.ALIGNING: ("lock", "align"),
    Phase.DRILLING: ("insert", "retract"),
    Phase.INSERTING: ("release",),
}


class ProcedurePage(SessionPage):
    """What can be done in the present phase besides moving the tool."""

    name = "procedure"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        alignment = session.state.alignment
        is_far = alignment is not None and not alignment.is_exact
        can_align = session.setup.settings.procedure.self_alignment
        if session.training.phase is Phase.ALIGNING and is_far and can_align:
            self.first = "align"

    def menu(self) -> Menu:
        """Return the choices of the phase; none where it has ended meanwhile."""
        phase = self.session.training.phase
        items = tuple(self._item(name) for name in _ITEMS.get(phase, ()) if self._is_offered(name))
        text = (self.session.texts.again(self.session.training.instruction),)
        title = self.say(f"procedure.title.{phase.value}") if phase in _ITEMS else ""
        return Menu(self.name, title, text, items=(*items, self.button("work")))

    def accept(self, item: str) -> None:
        """Do what was chosen; a refusal is said over the picture."""
        self.session.pages.close()
        if item in _COMMANDS:
            arguments = {"standOffMm": STAND_OFF_MM} if item == "align" else {}
            self.session.do(_COMMANDS[item], arguments)

    def _is_offered(self, name: str) -> bool:
        return name != "align" or self.session.setup.settings.procedure.self_alignment

    def _item(self, name: str) -> MenuItem:
        procedure = self.session.training.procedure
        waits = name == "accept" and (procedure is None or procedure.registration is None)
        help_ = self.say("procedure.waits" if waits else f"procedure.{name} help")
        return self.button(name, is_enabled=not waits, help=help_)
