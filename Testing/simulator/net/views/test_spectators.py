"""A spectator sees everything that a view sees, and no message of it drives anything."""

import aiohttp
import pytest

from rastrainer_simulator.net.views import guarded_server, view_server
from rastrainer_simulator.presentation.messages import (
    INPUTS,
    Alive,
    Feedback,
    ViewRole,
)
from rastrainer_simulator.presentation.presenter import Control
from rastrainer_simulator.presentation.screen import Screen, ScreenMessage
from Testing.security.stream_attack import MESSAGES
from Testing.simulator.net.views.served import HELLO

EXAMPLES = {message["type"]: message for message in MESSAGES}
EYES = [0.5, -0.6, 1.25, 0.0, 0.6, 0.0, 0.8]
HAND = [0.4, -0.2, 1.0, 0.0, 0.0, 0.0, 1.0]
WORN = {"type": "headsetPose", "eyes": EYES, "left": None, "right": HAND}
TOLD = {"eyes": EYES, "left": None, "right": HAND}
NOTHING_ELSE = (1008, "A spectator drives nothing: it may send alive and nothing else.")


def watch(served, connect, role=ViewRole.SPECTATOR, kind="spectator"):
    """Return a spectator, or a board, that has joined."""
    spectator = connect(served, role)
    spectator.join(kind=kind)
    return spectator


def wearers(view):
    """Yield the wearer of a headset in each state that a spectator reads."""
    while True:
        yield view.next("state")["headset"]


def is_cut_off(view):
    """Read on until the connection ends without a word; return whether it has."""
    try:
        while True:
            view.next()
    except (AssertionError, aiohttp.ClientError):
        return True


def until(wanted, view):
    next(wearer for wearer in wearers(view) if wearer == wanted)


@pytest.mark.parametrize(
    ("role", "watcher"),
    [
        (ViewRole.VIEW, "spectator"),
        (ViewRole.SPECTATOR, "spectator"),
        (ViewRole.BOARD, "board"),
    ],
)
def test_a_spectator_that_sends_anything_is_closed_without_any_effect(
    served, connect, role, watcher
):
    for kind in INPUTS.keys() - {Alive.type}:
        spectator = watch(served, connect, role, watcher)
        spectator.send(EXAMPLES[Alive.type])
        spectator.send(EXAMPLES[kind])
        assert spectator.closing() == NOTHING_ELSE, kind
    assert served.presenter.calls == []


def test_a_spectators_key_lets_no_view_join(served, connect):
    for role in (ViewRole.SPECTATOR, ViewRole.BOARD):
        for kind in ("desktop", "page", "headset"):
            spectator = connect(served, role)
            spectator.send({**HELLO, "kind": kind})
            assert spectator.closing()[0] == 1008
    assert served.presenter.calls == []


def test_spectators_are_not_counted_among_those_who_see_a_trial(served, connect):
    spectator = watch(served, connect)
    view = connect(served)
    number = view.join()["view"]
    spectator.leave()
    watch(served, connect)
    view.leave()
    calls = served.wait_for_call("view_left", number)
    assert [call[:2] for call in calls] == [("view_joined", number), ("view_left", number)]


def test_a_spectator_is_sent_everything_that_a_view_is_except_the_code(served, connect):
    served.presenter.screen = Screen(instruction=ScreenMessage("Touch 3"))
    view, spectator = connect(served), connect(served, ViewRole.SPECTATOR)
    view.join()
    spectator.join(kind="spectator")
    seen = [view.next("pairing")["code"], spectator.next("screen")["screen"]["instruction"]["text"]]
    assert seen == [served.code, "Touch 3"]
    served.tell(Feedback(1, "touch", "touch"), Control("gamepad"))
    for _ in range(2):
        messages = spectator.all_until(lambda message: message["type"] == "state")
        assert "pairing" not in {message["type"] for message in messages}
    # A new code is sent to the views, but to no spectator.
    served.thread.call(served.server.add_addresses, "https://192.0.2.1:18946")
    assert "https://192.0.2.1:18946" in view.next("pairing")["addresses"]
    served.tell(Feedback(2, "touch"))
    until_last = spectator.all_until(lambda m: m["type"] == "event" and m["number"] == 2)
    assert "pairing" not in {message["type"] for message in until_last}


def test_only_a_spectator_is_sent_the_pose_of_a_headsets_eyes_and_hands(served, connect):
    headset, spectator, page = connect(served), watch(served, connect), connect(served)
    headset.join(kind="headset")
    page.join()
    assert next(wearers(spectator)) is None
    headset.send(WORN)
    until(TOLD, spectator)
    assert page.next("state")["headset"] is None
    late = watch(served, connect)
    assert late.next("state")["headset"] == TOLD
    headset.send({**WORN, "eyes": None})
    until(None, spectator)


def test_spectators_do_not_use_up_the_slots_of_views(serve, connect, monkeypatch):
    monkeypatch.setattr(view_server, "SPECTATORS", 1)
    served = serve(views=1)
    watch(served, connect)
    with pytest.raises(aiohttp.WSServerHandshakeError, match="503"):
        connect(served, ViewRole.SPECTATOR)
    view = connect(served)
    assert view.join()["type"] == "welcome"


def test_a_spectators_connection_is_dropped_for_a_view_when_there_are_too_many(
    served, connect, monkeypatch
):
    monkeypatch.setattr(guarded_server, "MAX_CONNECTIONS", 2)
    view, spectator = connect(served), watch(served, connect)
    view.join()
    again = connect(served)
    again.join()
    assert is_cut_off(spectator)
    assert view.next("state")["type"] == again.next("state")["type"] == "state"
