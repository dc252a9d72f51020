"""A simulator informs boards of its seat, remembers their keys, and accepts orders with its PIN."""

from __future__ import annotations

import json
import stat

import pytest

from rastrainer_simulator.net.views.access_control import BOARDS_FILE, Sessions
from rastrainer_simulator.ops.instructor_pin import PIN_FILE, InstructorPin
from rastrainer_simulator.presentation.messages import Seat, ViewRole
from Testing.simulator.net.views.served import request

PIN = "271828"


def order(served, key, **values):
    """Return status, headers and sentence of an order."""
    status, headers, body = request(
        served.url,
        "/instructor",
        "POST",
        headers={"Authorization": f"Bearer {key}"},
        data=json.dumps({"pin": PIN, "order": "pause", "text": "", **values}),
    )
    return status, headers, body.decode()


@pytest.fixture
def guarded(serve, tmp_path):
    InstructorPin(tmp_path).set(PIN)
    return serve(config=tmp_path)


def test_a_board_is_sent_only_the_seat_and_only_when_it_has_changed(served, connect):
    served.presenter.reported_seat = Seat("P07", "Task 1", 15, score=80.0)
    board = connect(served, ViewRole.BOARD)
    board.join(kind="board")
    first = board.next()
    shown = (first["type"], first["trainee"], first["task"], first["score"], first["phase"])
    assert shown == ("seat", "P07", "Task 1", 80.0, "idle")
    served.presenter.reported_seat = Seat("P08")
    # No state, screen or other seat came between the two.
    second = board.next()
    assert (second["type"], second["trainee"], second["score"]) == ("seat", "P08", None)
    assert served.presenter.calls == []


def test_a_boards_key_outlives_the_simulator_and_others_do_not(tmp_path):
    path = tmp_path / BOARDS_FILE
    first = Sessions(path)
    keys = {role: first.open(role) for role in ViewRole}
    again = Sessions(path)
    assert {role: again.role(key) for role, key in keys.items()} == {
        ViewRole.VIEW: None,
        ViewRole.SPECTATOR: None,
        ViewRole.BOARD: ViewRole.BOARD,
    }
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert keys[ViewRole.BOARD] not in path.read_text(encoding="utf-8")


def test_a_damaged_boards_file_is_named(tmp_path):
    path = tmp_path / BOARDS_FILE
    for content in ("{}7", f'["{"x" * 64}"]', "7"):
        path.write_text(content, encoding="utf-8")
        with pytest.raises(ValueError, match=BOARDS_FILE):
            Sessions(path)


def test_only_a_board_can_give_orders_and_only_where_there_is_a_pin(guarded, serve, tmp_path):
    for role in (ViewRole.VIEW, ViewRole.SPECTATOR):
        assert order(guarded, guarded.new_key(role))[0] == 403
    assert guarded.presenter.calls == []
    for served in (serve(config=tmp_path / "empty"), serve()):
        status, _headers, sentence = order(served, served.new_key(ViewRole.BOARD))
        assert (status, "set a PIN there" in sentence) == (409, True)
        assert served.presenter.calls == []


def test_five_wrong_pins_start_a_pause_in_which_the_right_one_is_refused_too(guarded):
    guarded.pin._limit._clock = lambda: 100.0
    key = guarded.new_key(ViewRole.BOARD)
    statuses = [order(guarded, key, pin=f"{n:06}")[0] for n in range(5)]
    assert statuses == [403] * 4 + [429]
    status, headers, sentence = order(guarded, key)
    assert (status, sentence) == (429, "There were too many wrong PINs: wait.")
    assert headers["Retry-After"] == "1"
    assert guarded.presenter.calls == []


def test_an_order_with_the_pin_is_carried_out_or_says_why_not(guarded):
    key = guarded.new_key(ViewRole.BOARD)
    assert order(guarded, key, order="say", text=" Slowly. ")[0] == 200
    guarded.presenter.problem = "Nothing is running."
    assert order(guarded, key, order="replay")[::2] == (409, "Nothing is running.")
    assert guarded.presenter.calls == [("instruct", "say", "Slowly."), ("instruct", "replay", "")]


def test_an_invalid_order_is_answered_with_what_would_be_right(guarded):
    key = guarded.new_key(ViewRole.BOARD)
    for values, words in (
        ({"order": "drive"}, "order must be one of pause, say, replay"),
        ({"pin": 271828}, "pin must be"),
        ({"order": "say", "text": "x" * 201}, "text must be"),
        ({"order": "say", "text": "a\x1b"}, "text must be"),
    ):
        status, _headers, sentence = order(guarded, key, **values)
        assert (status, words in sentence) == (400, True)
    assert guarded.presenter.calls == []


def test_a_pin_is_stored_as_a_slow_hash_readable_only_by_its_owner(tmp_path):
    pin = InstructorPin(tmp_path / "config")
    for wrong in ("12345", "1234567890123", "12345a", "١٢٣٤٥٦"):
        with pytest.raises(ValueError, match="A PIN has 6 to 12 digits"):
            pin.set(wrong)
    assert not pin.is_set
    pin.set(PIN)
    path = tmp_path / "config" / PIN_FILE
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert PIN not in path.read_text(encoding="utf-8")
    assert [pin.guess(guess).is_right for guess in (PIN, "271829", "")] == [True, False, False]
    pin.set("")
    assert not pin.is_set


def test_a_damaged_pin_file_lets_nobody_in(serve, tmp_path):
    for content in ("{}", '{"salt": "!", "hash": 7}'):
        (tmp_path / PIN_FILE).write_text(content, encoding="utf-8")
        served = serve(config=tmp_path)
        status, _headers, sentence = order(served, served.new_key(ViewRole.BOARD))
        assert status in (403, 409)
        assert "instructor-pin" in sentence
        assert served.presenter.calls == []
