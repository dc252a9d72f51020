"""The controls: which input does what, a page to try them, and pages to change them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import TypeVar

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import (
    IN_MENUS,
    OF_VIEW,
    ROTATION,
    STICKS,
    TRANSLATION,
    ControlName,
    InputDevice,
)
from rastrainer_simulator.input.presets import preset_name, presets_of
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import Fact, ItemKind, Menu, MenuItem

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

    def menu(self) -> Menu:
        """Return the list of the controls."""
        session = self.session
        # Two directions of a stick identify it; a key has only one.
        most = len(ControlName) if session.operator.kind is InputDevice.KEYBOARD else 2
        facts = tuple(
            Fact(
                self.say(f"controls.{key}"),
                " / ".join(map(session.operator.label, controls[:most])),
            )
            for key, controls in _LISTED
        )
        items = (*(["next"] if self._leads_on else []), "test", "rebind", "back")
        return Menu(
            self.name,
            self.say("controls.title"),
            (self.say("controls.text"),),
            facts,
            tuple(self.button(item) for item in items),
            picture=session.operator.picture,
        )

    def accept(self, item: str) -> None:
        """Continue, try the controls or change them."""
        pages = self.session.pages
        if item == "next":
            self.session.has_read_introduction = True
            pages.replace(ExperimentPage(self.session))
        elif item == "back":
            self.back()
        else:
            pages.open((PadTestPage if item == "test" else BindingsPage)(self.session))


class PadTestPage(SessionPage):
    """Shows what arrives. Every input but the menu's is only shown; the menu's leaves."""

    name = "test"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._pressed: list[tuple[InputDevice, str]] = []

    def menu(self) -> Menu:
        """Return the sticks' positions and the last inputs."""
        held = self.session.held
        positions = (*held.translation, *held.rotation)
        axes = tuple(
            MenuItem(f"axis{number}", self._axis(pair), ItemKind.AXIS, f"{position:.2f}", False)
            for number, (pair, position) in enumerate(
                zip((*TRANSLATION, *ROTATION), positions, strict=True)
            )
        )
        fine = Fact(self.say("control.fine"), self.say("test.yes" if held.fine else "test.no"))
        facts = tuple(Fact(*self._input(*pressed)) for pressed in self._pressed)
        leave = self.session.operator.label(ControlName.MENU)
        return Menu(
            self.name,
            self.say("test.title"),
            (self.say("test.text", menu=leave),),
            (fine, *facts),
            (*axes, self.button("back")),
        )

    def accept(self, item: str) -> None:
        if item == "back":
            self.back()

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Show an input, and let it be felt."""
        if name in self.session.bindings.table(device)[ControlName.MENU]:
            return False
        self._pressed = [(device, name), *self._pressed][:REMEMBERED]
        self.session.happened(FeedbackEvent.TEST)
        return True

    def _axis(self, pair: tuple[ControlName, ControlName]) -> str:
        return " / ".join(self.say(f"control.{control.value}") for control in pair)

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

T = TypeVar("T")


class BindingsPage(SessionPage):
    """The controls of a device, a group at a time."""

    name = "bindings"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._device = session.operator.kind
        self._group = "work"

    def menu(self) -> Menu:
        """Return the controls of the group with their inputs."""
        device = self.choice("device", self.say(f"device.{self._device.value}"))
        preset = self.choice("preset", self.say(f"bindings.preset.{self._preset or 'own'}"))
        group = self.choice("group", self.say(f"bindings.group.{self._group}"))
        controls = tuple(self._control(control) for control in GROUPS[self._group])
        items = (device, preset, group, *controls, self.button("defaults"), self.button("back"))
        return Menu(self.name, self.say("bindings.title"), items=items)

    def accept(self, item: str) -> None:
        """Listen for a control's new input, or go back to the defaults."""
        session = self.session
        if item == "back":
            self.back()
        elif item == "defaults":
            session.rebind(DEFAULT_BINDINGS)
            session.notices.add(self.say("bindings.are default"))
        else:
            session.pages.open(ListenPage(session, self._device, ControlName(item)))

    def step(self, item: str, direction: int) -> None:
        """Show another device or group, or take another preset for the device."""
        if item == "device":
            self._device = _stepped(tuple(InputDevice), self._device, direction)
        elif item == "preset":
            self._take_preset(direction)
        elif item == "group":
            self._group = _stepped(tuple(GROUPS), self._group, direction)

    @property
    def _preset(self) -> str | None:
        return preset_name(self._device, self.session.bindings.table(self._device))

    def _take_preset(self, direction: int) -> None:
        presets = presets_of(self._device)
        names = tuple(presets)
        name = names[0] if self._preset is None else _stepped(names, self._preset, direction)
        changed = {self._device.value: presets[name]}
        self.session.rebind(dataclasses.replace(self.session.bindings, **changed))

    def _control(self, control: ControlName) -> MenuItem:
        inputs = self.session.operator.input_labels(self._device, control)
        return self.button(control.value, self.say(f"control.{control.value}"), value=inputs)


class ListenPage(SessionPage):
    """Waits for the new input of one control; the control for the menu cancels it."""

    name = "listen"

    def __init__(self, session: TrainingSession, device: InputDevice, control: ControlName) -> None:
        super().__init__(session)
        self._device = device
        self._control = control
        self._left = LISTEN_S

    def menu(self) -> Menu:
        """Return the request for an input."""
        control = self.say(f"control.{self._control.value}")
        key = f"listen.{self._device.value}"
        text = self.say(key, control=control, seconds=math.ceil(self._left))
        title = self.say("listen.title", control=control)
        return Menu(self.name, title, (text,), items=(self.button("cancel"),))

    def accept(self, item: str) -> None:  # noqa: ARG002
        """Cancel."""
        self.back()

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

    def menu(self) -> Menu:
        """Return the question."""
        others = self.session.bindings.others(self._device, self._control, self._wanted)
        text = self.say(
            "conflict.text",
            input=self.session.operator.input_label(self._device, self._wanted),
            other=self.session.texts.listed(self.say(f"control.{other.value}") for other in others),
            control=self.say(f"control.{self._control.value}"),
        )
        items = tuple(self.button(item) for item in ("exchange", "another", "cancel"))
        return Menu(self.name, self.say("conflict.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Exchange, listen again, or cancel."""
        pages = self.session.pages
        if item == "another":
            pages.replace(ListenPage(self.session, self._device, self._control))
            return
        pages.close()
        if item == "exchange":
            rebind(self.session, self._device, self._control, self._wanted)


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


def _stepped(options: Sequence[T], value: T, direction: int) -> T:
    return options[(options.index(value) + direction) % len(options)]
