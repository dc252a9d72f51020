"""The controls: which input does what, a page to try them, and pages to change them."""

from __future__ import annotations

import math
from functools import partial

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
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
        page.button("test", page.open_page(pad_test_page)),
        page.button(
            "rebind", lambda: session.pages.open(bindings_page(session, device=operator.kind))
        ),
        page.button("back"),
    )
    return PageContent((page.say("controls.text"),), facts, rows, picture=operator.picture)


Pressed = tuple[tuple[InputDevice, str], ...]
"""Inputs with their devices, the newest first."""


def _show_input(page: SessionPage, device: InputDevice, name: str, pressed: Pressed = ()) -> bool:
    if name in page.session.controls.bindings.table(device)[ControlName.MENU]:
        return False
    page.set_value("pressed", ((device, name), *pressed)[:REMEMBERED])
    page.session.happened(FeedbackEvent.TEST)
    return True


@page_kind("test", input_pressed=_show_input)
def pad_test_page(page: SessionPage, pressed: Pressed = ()) -> PageContent:
    """Show every input that arrives, except the menu's, which leaves."""
    session, say, held = page.session, page.say, page.session.controls.held
    pairs = zip((*TRANSLATION, *ROTATION), (*held.translation, *held.rotation), strict=True)
    axes = (
        page.button(
            f"axis{number}",
            label=" / ".join(say(f"control.{control.value}") for control in controls),
            kind=ItemKind.AXIS,
            value=f"{position:.2f}",
            is_enabled=False,
        )
        for number, (controls, position) in enumerate(pairs)
    )
    facts = [Fact(say("control.fine"), say("test.yes" if held.fine else "test.no"))]
    for device, name in pressed:
        table = session.controls.bindings.table(device)
        works = [say(f"control.{each.value}") for each in table if name in table[each]]
        label = session.operator.input_label(device, name)
        facts.append(Fact(label, session.texts.listed(works) or say("test.nothing")))
    text = say("test.text", menu=session.operator.label(ControlName.MENU))
    return PageContent((text,), facts, (*axes, page.button("back")))


GROUPS = {
    "work": tuple(name for name in ControlName if name not in (STICKS | OF_VIEW | {*IN_MENUS})),
    "movement": tuple(name for name in ControlName if name in STICKS),
    "view": tuple(name for name in ControlName if name in OF_VIEW),
    "menus": IN_MENUS,
}
LISTEN_S = 10.0


@page_kind("bindings")
def bindings_page(page: SessionPage, device: InputDevice, group: str = "work") -> PageContent:
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
        listen = page.open_page(listen_page, device, control)
        label = say(f"control.{control.value}")
        return page.button(control.value, listen, label, value=session.texts.listed(inputs))

    shown = say(f"bindings.preset.{preset or 'own'}")
    rows = (
        page.choice("device", tuple(InputDevice), device, say(f"device.{device.value}")),
        page.choice("preset", tuple(presets), preset, shown, use_preset),
        page.choice("group", tuple(GROUPS), group, say(f"bindings.group.{group}")),
        *map(control_row, GROUPS[group]),
        page.button("defaults", restore_defaults),
        page.button("back"),
    )
    return PageContent(rows=rows)


def _count_down(page: SessionPage, dt: float, *_wanted: object, left_s: float = LISTEN_S) -> None:
    page.set_value("left_s", left_s - dt)
    if left_s <= dt:
        page.back()


def _take_new_input(
    page: SessionPage,
    pressed: InputDevice,
    name: str,
    device: InputDevice,
    control: ControlName,
    **_left: float,
) -> bool:
    session = page.session
    if pressed is not device:
        return False
    if session.controls.bindings.others(device, control, name):
        session.pages.replace(conflict_page(session, device, control, name))
    else:
        session.pages.close()
        rebind(session, device, control, name)
    return True


@page_kind("listen", advance=_count_down, input_pressed=_take_new_input)
def listen_page(
    page: SessionPage, device: InputDevice, control: ControlName, left_s: float = LISTEN_S
) -> PageContent:
    """Wait for the new input of a control; the control for the menu cancels it."""
    name = page.say(f"control.{control.value}")
    text = page.say(f"listen.{device.value}", control=name, seconds=math.ceil(left_s))
    title = page.say("listen.title", control=name)
    return PageContent((text,), rows=(page.button("cancel"),), title=title)


@page_kind("conflict")
def conflict_page(
    page: SessionPage, device: InputDevice, control: ControlName, wanted: str
) -> PageContent:
    """Ask what to do with an input of another control: exchange the two, or change nothing."""
    session = page.session

    def exchange() -> None:
        page.back()
        rebind(session, device, control, wanted)

    listen_again = partial(session.pages.replace, listen_page(session, device, control))
    others = session.controls.bindings.others(device, control, wanted)
    text = page.say(
        "conflict.text",
        input=session.operator.input_label(device, wanted),
        other=session.texts.listed(page.say(f"control.{other.value}") for other in others),
        control=page.say(f"control.{control.value}"),
    )
    rows = (
        page.button("exchange", exchange),
        page.button("another", listen_again),
        page.button("cancel"),
    )
    return PageContent((text,), rows=rows)


def rebind(session: TrainingSession, device: InputDevice, control: ControlName, name: str) -> None:
    """Give a control its new input and say so, or say why that is impossible."""
    try:
        bindings = session.controls.bindings.rebound(device, control, name)
    except InputError:
        session.complain(session.say("bindings.impossible"))
        return
    session.rebind(bindings)
    session.notices.add(
        session.say(
            "bindings.changed",
            control=session.say(f"control.{control.value}"),
            input=session.operator.input_label(device, name),
        )
    )
