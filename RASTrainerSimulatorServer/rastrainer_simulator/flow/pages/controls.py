"""The controls: which input does what, a page to try them, and pages to change them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from typing import TypeVar

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.session_page import SessionPage, ShownPage, page_kind
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
T = TypeVar("T")
REMEMBERED = 4
"""Number of inputs shown on the page to try them."""


@page_kind("controls")
def controls_page(page: SessionPage, leads_on: bool = False) -> PageContent:
    session, operator = page.session, page.session.operator

    def lead_on() -> None:
        session.has_read_introduction = True
        session.pages.replace(ExperimentPage(session))

    # Two directions of a stick identify it; a key has only one.
    most = len(ControlName) if operator.kind is InputDevice.KEYBOARD else 2
    facts = [
        Fact(page.say(f"controls.{key}"), " / ".join(map(operator.label, controls[:most])))
        for key, controls in _LISTED
    ]
    rows = (
        *((page.button("next", lead_on),) if leads_on else ()),
        page.button("test", page.open_page(PadTestPage)),
        page.button(
            "rebind", lambda: session.pages.open(bindings_page(session, device=operator.kind))
        ),
        page.button("back"),
    )
    return PageContent((page.say("controls.text"),), facts, rows, picture=operator.picture)


class PadTestPage(SessionPage):
    """Shows what arrives. Every input but the menu's is only shown; the menu's leaves."""

    name = "test"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._pressed: list[tuple[InputDevice, str]] = []

    def content(self) -> PageContent:
        held = self.session.controls.held
        pairs = zip((*TRANSLATION, *ROTATION), (*held.translation, *held.rotation), strict=True)
        axes = (
            self.button(
                f"axis{number}",
                label=" / ".join(self.say(f"control.{control.value}") for control in controls),
                kind=ItemKind.AXIS,
                value=f"{position:.2f}",
                is_enabled=False,
            )
            for number, (controls, position) in enumerate(pairs)
        )
        facts = [Fact(self.say("control.fine"), self.say("test.yes" if held.fine else "test.no"))]
        for device, name in self._pressed:
            table = self.session.controls.bindings.table(device)
            works = [self.say(f"control.{each.value}") for each in table if name in table[each]]
            label = self.session.operator.input_label(device, name)
            facts.append(Fact(label, self.session.texts.listed(works) or self.say("test.nothing")))
        text = self.say("test.text", menu=self.session.operator.label(ControlName.MENU))
        return PageContent((text,), facts, (*axes, self.button("back")))

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        if name in self.session.controls.bindings.table(device)[ControlName.MENU]:
            return False
        self._pressed = [(device, name), *self._pressed][:REMEMBERED]
        self.session.happened(FeedbackEvent.TEST)
        return True


GROUPS = {
    "work": tuple(name for name in ControlName if name not in (STICKS | OF_VIEW | {*IN_MENUS})),
    "movement": tuple(name for name in ControlName if name in STICKS),
    "view": tuple(name for name in ControlName if name in OF_VIEW),
    "menus": IN_MENUS,
}
LISTEN_S = 10.0


@page_kind("bindings")
def bindings_page(page: ShownPage, device: InputDevice, group: str = "work") -> PageContent:
    session, say = page.session, page.say
    table, presets = session.controls.bindings.table(device), LAYOUTS[device]
    preset = preset_name(device, table)

    def use_preset(name: str | None) -> None:
        assert name is not None, "it is chosen among the presets"
        session.rebind(session.controls.bindings.with_table(device, presets[name]))

    def restore_defaults() -> None:
        session.rebind(DEFAULT_BINDINGS)
        session.notices.add(say("bindings.are default"))

    def control_row(control: ControlName) -> PageRow:
        inputs = (session.operator.input_label(device, name) for name in table[control])
        listen = page.open_page(ListenPage, device, control)
        label = say(f"control.{control.value}")
        return page.button(control.value, listen, label, value=session.texts.listed(inputs))

    def shown(name: str, options: Sequence[T], chosen: T, key: str) -> PageRow:
        return page.choice(name, options, chosen, partial(page.set_value, name), say(key))

    rows = (
        shown("device", tuple(InputDevice), device, f"device.{device.value}"),
        page.choice(
            "preset", tuple(presets), preset, use_preset, say(f"bindings.preset.{preset or 'own'}")
        ),
        shown("group", tuple(GROUPS), group, f"bindings.group.{group}"),
        *map(control_row, GROUPS[group]),
        page.button("defaults", restore_defaults),
        page.button("back"),
    )
    return PageContent(rows=rows)


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
        return PageContent((text,), rows=(self.button("cancel"),), title=title)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        if device is not self._device:
            return False
        session, wanted = self.session, (device, self._control, name)
        if session.controls.bindings.others(*wanted):
            session.pages.replace(conflict_page(session, *wanted))
        else:
            session.pages.close()
            rebind(session, *wanted)
        return True

    def advance(self, dt: float) -> None:
        self._left -= dt
        if self._left <= 0.0:
            self.back()


@page_kind("conflict")
def conflict_page(
    page: SessionPage, device: InputDevice, control: ControlName, wanted: str
) -> PageContent:
    """Ask what to do with an input of another control: exchange the two, or change nothing."""
    session = page.session

    def exchange() -> None:
        page.back()
        rebind(session, device, control, wanted)

    others = session.controls.bindings.others(device, control, wanted)
    text = page.say(
        "conflict.text",
        input=session.operator.input_label(device, wanted),
        other=session.texts.listed(page.say(f"control.{other.value}") for other in others),
        control=page.say(f"control.{control.value}"),
    )
    rows = (
        page.button("exchange", exchange),
        page.button("another", lambda: session.pages.replace(ListenPage(session, device, control))),
        page.button("cancel"),
    )
    return PageContent((text,), rows=rows)


def rebind(session: TrainingSession, device: InputDevice, control: ControlName, name: str) -> None:
    """Give a control its new input and say so, or say why that is impossible."""
    try:
        bindings = session.controls.bindings.rebound(device, control, name)
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
