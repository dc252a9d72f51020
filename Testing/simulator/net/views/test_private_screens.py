"""The content of a private menu is sent only to the operator."""

from __future__ import annotations

import pytest

from rastrainer_simulator.presentation.messages import Feedback, ViewRole
from rastrainer_simulator.presentation.presenter import Control
from rastrainer_simulator.presentation.screen import Fact, Menu, MenuItem, Screen

SECRET = Screen(
    menu=Menu(
        "pin", "PIN", ("Enter it.",), (Fact("PIN", "••_"),), (MenuItem("4", "4"),), focus="4"
    ),
    is_private=True,
)
BARE = {"name": "pin", "title": "PIN", "paragraphs": ["Enter it."], "facts": [], "items": []}
PLAIN = Screen(status=("plain",))


def joined(served, connect, kind, role=ViewRole.VIEW):
    view = connect(served, role)
    return view, view.join(kind=kind)["view"]


def screens_and_events(view):
    """Return the menus and events before the event that ends a test.

    Events come in order, after their screens; if a view reads slowly, the plain screen may come
    before an older event.
    """
    messages = view.all_until(
        lambda message: message["type"] == "event" and message["kind"] == "accept"
    )
    screens = [each["screen"] for each in messages if each["type"] == "screen"]
    menus = [screen["menu"] for screen in screens if screen["menu"] is not None]
    return menus, [each["kind"] for each in messages[:-1] if each["type"] == "event"]


def tell(served, control):
    """Have an operator take control while the private menu is open, hear a click, and leave."""

    def act(presenter):
        presenter.control, presenter.screen = control, SECRET
        presenter.tell(SECRET, control, Feedback(1, "focus"))

    served.thread.call(act, served.presenter)


def finish(served):
    def act(presenter):
        presenter.screen = PLAIN
        presenter.tell(PLAIN, Feedback(2, "accept"))

    served.thread.call(act, served.presenter)


def is_bare(menu) -> bool:
    return {name: menu[name] for name in BARE} == BARE and menu["focus"] == ""


@pytest.fixture
def seat(served, connect):
    """Return views and their numbers by name: two windows, two pages, a spectator."""
    kinds = {"window": "desktop", "other window": "desktop", "page": "page", "other page": "page"}
    views = {name: joined(served, connect, kind) for name, kind in kinds.items()}
    views["spectator"] = joined(served, connect, "spectator", ViewRole.SPECTATOR)
    for view, _number in views.values():
        view.next("screen")
    return views


@pytest.mark.parametrize(
    ("holder", "readers"), [("page", {"page"}), ("gamepad", {"window", "other window"})]
)
def test_only_the_operators_views_are_sent_items_focus_and_clicks(served, seat, holder, readers):
    number = seat[holder][1] if holder in seat else None
    tell(served, Control(holder, number))
    finish(served)
    for name, (view, _number) in seat.items():
        menus, events = screens_and_events(view)
        # A view that reads slowly is sent only the latest screen.
        assert all(is_bare(menu) is (name not in readers) for menu in menus), name
        assert events == (["focus"] if name in readers else []), name


def test_the_view_that_takes_control_is_sent_the_whole_menu_and_the_one_that_lost_it_none(
    served, seat
):
    (first, number), (second, other) = seat["page"], seat["other page"]
    tell(served, Control("page", number))
    assert not is_bare(first.next("screen")["screen"]["menu"])
    assert is_bare(second.next("screen")["screen"]["menu"])
    tell(served, Control("page", other))

    def until(view, wanted):
        while is_bare(view.next("screen")["screen"]["menu"]) is not wanted:
            pass

    until(first, True)
    until(second, False)
