"""The controls: which input does what, a page to try them, and pages to change them."""

from __future__ import annotations

import math

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.session_page import SessionPage, stepped
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS, LAYOUTS, preset_name
from rastrainer_simulator.input.inputs import (
    IN_MENUS,
    OF_VIEW,
    ROTATION,
    STICKS,
    TRANSLATION,
    ControlName,
    InputDevice,
)
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import Fact, ItemKind

_LISTED = (
    ("move_along", (ControlName.MOVE_FORWARD, ControlName.MOVE_BACK)),
    ("move_across", (ControlName.MOVE_LEFT, ControlName.MOVE_RIGHT)),
    ("move_vertically", (ControlName.MOVE_UP, ControlName.MOVE_DOWN)),
    ("fine", (ControlName.FINE,)),
    ("touch", (ControlName.TOUCH,)),
    ("undo", (ControlName.UNDO,)),
    ("best_view", (ControlName.BEST_VIEW,)),
    ("turn_view", (ControlName.VIEW_LEFT, ControlName.VIEW_RIGHT)),
    ("tilt_view", (ControlName.VIEW_HIGHER, ControlName.VIEW_LOWER)),
    ("zoom_view", (ControlName.VIEW_NEARER, ControlName.VIEW_FARTHER)),
    ("camera", (ControlName.CAMERA,)),
    ("pause", (ControlName.PAUSE,)),
    ("menu", (ControlName.MENU,)),
)
REMEMBERED = 4
"""Number of inputs shown on the page to try them."""


class ControlsPage(SessionPage):
    """Which input does what, on the device in the reader's hands."""

    name = "controls"

    def __init__(self, session: TrainingSession, leads_on: bool = False) -> None:
        super().__init__(session)
        self._leads_on = leads_on

    def content(self) -> PageContent:
        operator = self.session.operator
        # Two directions of a stick identify it; a key has only one.
        most = len(ControlName) if operator.kind is InputDevice.KEYBOARD else 2
        facts = [
            Fact(self.say(f"controls.{key}"), " / ".join(map(operator.label, controls[:most])))
            for key, controls in _LISTED
        ]
        rows = (
            *((self.button("next", self._lead_on),) if self._leads_on else ()),
            self.button("test", self.open_page(PadTestPage)),
            self.button("rebind", self.open_page(BindingsPage)),
            self.button("back"),
        )
        title, text = self.say("controls.title"), self.say("controls.text")
        return PageContent(title, (text,), facts, rows, operator.picture)

    def _lead_on(self) -> None:
        self.session.has_read_introduction = True
        self.session.pages.replace(ExperimentPage(self.session))


class PadTestPage(SessionPage):
    """Shows what arrives. Every input but the menu's is only shown; the menu's leaves."""

    name = "test"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._pressed: list[tuple[InputDevice, str]] = []

    def content(self) -> PageContent:
        held = self.session.held
        pairs = zip((*TRANSLATION, *ROTATION), (*held.translation, *held.rotation), strict=True)
        axes = (self._axis(number, *pair) for number, pair in enumerate(pairs))
        fine = Fact(self.say("control.fine"), self.say("test.yes" if held.fine else "test.no"))
        facts = (fine, *(Fact(*self._input(*pressed)) for pressed in self._pressed))
        text = self.say("test.text", menu=self.session.operator.label(ControlName.MENU))
        return PageContent(self.say("test.title"), (text,), facts, (*axes, self.button("back")))

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Show an input, and let it be felt."""
        if name in self.session.bindings.table(device)[ControlName.MENU]:
            return False
        self._pressed = [(device, name), *self._pressed][:REMEMBERED]
        self.session.happened(FeedbackEvent.TEST)
        return True

    def _axis(self, number: int, pair: tuple[ControlName, ControlName], position: float) -> PageRow:
        label = " / ".join(self.say(f"control.{control.value}") for control in pair)
        return self.button(
            f"axis{number}",
            label=label,
            kind=ItemKind.AXIS,
            value=f"{position:.2f}",
            is_enabled=False,
        )

    def _input(self, device: InputDevice, name: str) -> tuple[str, str]:
        table = self.session.bindings.table(device)
        works = [control for control, inputs in table.items() if name in inputs]
        names = self.session.texts.listed(self.say(f"control.{each.value}") for each in works)
        return self.session.operator.input_label(device, name), names or self.say("test.nothing")


GROUPS = {
    "work": tuple(name for name in ControlName if name not in (STICKS | OF_VIEW | {*IN_MENUS})),
    "movement": tuple(name for name in ControlName if name in STICKS),
    "view": tuple(name for name in ControlName if name in OF_VIEW),
    "menus": IN_MENUS,
}
LISTEN_S = 10.0


class BindingsPage(SessionPage):
    """The controls of a device, a group at a time."""

    name = "bindings"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._device = session.operator.kind
        self._group = "work"

    def content(self) -> PageContent:
        device = self.say(f"device.{self._device.value}")
        preset = self.say(f"bindings.preset.{self._preset or 'own'}")
        group = self.say(f"bindings.group.{self._group}")
        rows = (
            self.choice("device", device, self._step_device),
            self.choice("preset", preset, self._step_preset),
            self.choice("group", group, self._step_group),
            *map(self._control, GROUPS[self._group]),
            self.button("defaults", self._restore_defaults),
            self.button("back"),
        )
        return PageContent(self.say("bindings.title"), rows=rows)

    def _restore_defaults(self) -> None:
        self.session.rebind(DEFAULT_BINDINGS)
        self.session.notices.add(self.say("bindings.are default"))

    def _step_device(self, direction: int) -> None:
        self._device = stepped(tuple(InputDevice), self._device, direction)

    def _step_group(self, direction: int) -> None:
        self._group = stepped(tuple(GROUPS), self._group, direction)

    @property
    def _preset(self) -> str | None:
        return preset_name(self._device, self.session.bindings.table(self._device))

    def _step_preset(self, direction: int) -> None:
        presets = LAYOUTS[self._device]
        names = tuple(presets)
        name = names[0] if self._preset is None else stepped(names, self._preset, direction)
        self.session.rebind(self.session.bindings.with_table(self._device, presets[name]))

    def _control(self, control: ControlName) -> PageRow:
        """Return a control with its inputs; accepting it waits for a new one."""
        inputs = self.session.operator.input_labels(self._device, control)
        listen = self.open_page(ListenPage, self._device, control)
        return self.button(
            control.value, listen, self.say(f"control.{control.value}"), value=inputs
        )


class ListenPage(SessionPage):
    """Waits for the new input of one control; the control for the menu cancels it."""

    name = "listen"

    def __init__(self, session: TrainingSession, device: InputDevice, control: ControlName) -> None:
        super().__init__(session)
        self._device = device
        self._control = control
        self._left = LISTEN_S

    def content(self) -> PageContent:
        control = self.say(f"control.{self._control.value}")
        key = f"listen.{self._device.value}"
        text = self.say(key, control=control, seconds=math.ceil(self._left))
        title = self.say("listen.title", control=control)
        return PageContent(title, (text,), rows=(self.button("cancel"),))

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Assign the input, or ask what to do about the control that has it now."""
        if device is not self._device:
            return False
        session = self.session
        others = session.bindings.others(device, self._control, name)
        if others:
            page = ConflictPage(session, device, self._control, name)
            session.pages.replace(page)
        else:
            session.pages.close()
            rebind(session, device, self._control, name)
        return True

    def advance(self, dt: float) -> None:
        """Give up after some time."""
        self._left -= dt
        if self._left <= 0.0:
            self.back()


class ConflictPage(SessionPage):
    """The input already belongs to another control: the two are exchanged, or nothing changes."""

    name = "conflict"

    def __init__(
        self, session: TrainingSession, device: InputDevice, control: ControlName, wanted: str
    ) -> None:
        super().__init__(session)
        self._device, self._control, self._wanted = device, control, wanted

    def content(self) -> PageContent:
        others = self.session.bindings.others(self._device, self._control, self._wanted)
        text = self.say(
            "conflict.text",
            input=self.session.operator.input_label(self._device, self._wanted),
            other=self.session.texts.listed(self.say(f"control.{other.value}") for other in others),
            control=self.say(f"control.{self._control.value}"),
        )
        rows = (
            self.button("exchange", self._exchange),
            self.button("another", self._listen_again),
            self.button("cancel"),
        )
        return PageContent(self.say("conflict.title"), (text,), rows=rows)

    def _exchange(self) -> None:
        self.back()
        rebind(self.session, self._device, self._control, self._wanted)

    def _listen_again(self) -> None:
        self.session.pages.replace(ListenPage(self.session, self._device, self._control))


def rebind(session: TrainingSession, device: InputDevice, control: ControlName, name: str) -> None:
    """Give a control its new input and say so, or say why that is impossible."""
    try:
        bindings = session.bindings.rebound(device, control, name)
    except InputError:
        session.complain(session.texts.say("bindings.impossible"))
        return
    session.rebind(bindings)
    session.notices.add(
        session.texts.say(
            "bindings.changed",
            control=session.texts.say(f"control.{control.value}"),
            input=session.operator.input_label(device, name),
        )
    )
