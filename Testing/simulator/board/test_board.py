"""A board watches seats over TLS, shows their state, and gives orders only with their PIN."""

from __future__ import annotations

import json
import stat

import aiohttp
import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer_simulator.board.seats import SEATS_FILE, checked_address, read_seats
from rastrainer_simulator.net.views.access_control import BOARDS_FILE
from rastrainer_simulator.presentation.messages import Seat, SeatNews
from Testing.simulator.board.conftest import PIN, WatchedSimulator
from Testing.simulator.net.views.served import HELLO, request

AT_WORK = Seat("P07", "Task 2", 15, instruction="Touch 3", score=71.5, holder="gamepad")
SPECTATOR = {**HELLO, "kind": "spectator"}


def is_watching(tiles) -> bool:
    return [tile["link"] for tile in tiles] == ["watching"]


def link_is(link: str):
    return lambda tiles: [tile["link"] for tile in tiles] == [link]


def test_a_seats_fingerprint_is_shown_before_anything_is_sent_to_it(board, simulator):
    values = {"name": "Door", "address": simulator.address, "code": "no code"}
    assert board.ask("/seats", "POST", **values) == (200, {"fingerprint": simulator.fingerprint})
    assert board.tiles_until(lambda _tiles: True) == []


def test_a_seats_state_is_shown_and_updated_for_each_teacher(board, simulator):
    simulator.served.presenter.reported_seat = AT_WORK
    seat = board.add(simulator)
    (tile,) = board.tiles_until(is_watching)
    assert (tile["id"], tile["name"], tile["address"]) == (seat, "Window 3", simulator.address)
    shown = tile["seat"]
    assert (shown["trainee"], shown["task"], shown["count"]) == ("P07", "Task 2", 15)
    assert (shown["score"], shown["holder"], shown["phase"]) == (71.5, "gamepad", "idle")
    simulator.served.presenter.reported_seat = Seat("P08")
    board.tiles_until(lambda tiles: is_watching(tiles) and tiles[0]["seat"]["trainee"] == "P08")
    assert board.tiles_until(is_watching) == board.tiles_until(is_watching, board.paired())


@pytest.fixture
def restarted(simulator, serve, certificates):
    """Return what ends the simulator and starts it again at the same address."""

    def restart(folder=certificates) -> WatchedSimulator:
        simulator.served.close()
        return WatchedSimulator(
            serve(config=simulator.config), simulator.config, folder, simulator.port
        )

    return restart


def test_seats_reappear_after_board_and_simulator_have_restarted(open_board, simulator, restarted):
    first = open_board()
    first.add(simulator)
    first.tiles_until(is_watching)
    simulator.served.close()
    first.tiles_until(link_is("away"))
    first.close()
    restarted()
    (tile,) = open_board().tiles_until(is_watching)
    assert tile["name"] == "Window 3"


def test_keys_are_readable_only_by_their_owner_and_a_seat_stores_only_hashes(board, simulator):
    board.add(simulator)
    own, seats = board.config / SEATS_FILE, simulator.config / BOARDS_FILE
    assert [stat.S_IMODE(path.stat().st_mode) for path in (own, seats)] == [0o600, 0o600]
    (entry,) = json.loads(own.read_text(encoding="utf-8"))["seats"]
    assert entry["key"] not in seats.read_text(encoding="utf-8")


def test_a_seat_with_another_certificate_is_sent_neither_key_nor_code(
    board, simulator, restarted, tmp_path
):
    board.add(simulator)
    board.tiles_until(is_watching)
    impostor, seen = restarted(tmp_path / "other"), []
    impostor.served.server.sessions.role = seen.append
    impostor.served.server.code.accepts = seen.append
    board.tiles_until(link_is("other certificate"))
    values = {"fingerprint": simulator.fingerprint, "code": impostor.served.code}
    status, answer = board.ask(
        "/seats", "POST", name="Window 3", address=impostor.address, **values
    )
    assert (status, answer.split(":")[0]) == (409, "The certificate has changed")
    assert seen == []


def test_a_seat_that_has_forgotten_the_board_must_be_paired_again(board, simulator, restarted):
    board.add(simulator)
    board.tiles_until(is_watching)
    (simulator.config / BOARDS_FILE).unlink()
    again = restarted()
    board.tiles_until(link_is("unpaired"))
    board.add(again)
    assert len(board.tiles_until(is_watching)) == 1


def test_a_removed_seat_is_forgotten_with_its_key(board, simulator):
    seat = board.add(simulator)
    board.tiles_until(is_watching)
    assert board.ask(f"/seat/{seat}", "DELETE") == (200, {})
    assert board.tiles_until(lambda _tiles: True) == []
    assert json.loads((board.config / SEATS_FILE).read_text(encoding="utf-8"))["seats"] == []
    assert board.ask(f"/seat/{seat}/role")[0] == 404


def test_a_problem_with_a_new_seat_is_reported_and_nothing_is_added(board, simulator):
    values = {
        "name": "Door",
        "address": simulator.address,
        "fingerprint": simulator.fingerprint,
        "code": simulator.served.code,
    }
    for changes, sentence in (
        ({"address": "http://192.0.2.7:18945"}, "Only a simulator on this computer is watched"),
        ({"address": "localhost:1", "fingerprint": ""}, "does not answer at http://localhost:1"),
        ({"address": "https://127.0.0.1:1"}, "does not answer at https://127.0.0.1:1"),
        ({"fingerprint": "12:34"}, "32 pairs of hexadecimal digits"),
        ({"name": ""}, "name must be printable text of 1 to 40 characters"),
        ({"code": "1"}, "This is not the pairing code that the simulator shows."),
    ):
        status, answer = board.ask("/seats", "POST", **{**values, **changes})
        assert status in (400, 409)
        assert sentence in answer
    assert board.tiles_until(lambda _tiles: True) == []


def test_an_address_that_is_none_of_a_simulator_is_refused():
    for address in ("ftp://127.0.0.1:1", "https://me:secret@127.0.0.1:1", "https://[127.0.0.1:1"):
        with pytest.raises(InputError, match="is not the address of a simulator"):
            checked_address(address)


def test_an_order_needs_the_pin_once_and_is_carried_out(board, simulator):
    path = f"/seat/{board.add(simulator)}/order"
    assert board.ask(path, "POST", order="pause") == (200, {"needsPin": True})
    status, answer = board.ask(path, "POST", order="pause", pin="000000")
    assert (status, answer) == (409, "This is not the PIN of this seat.")
    assert simulator.served.presenter.calls == []
    assert board.ask(path, "POST", order="pause", pin=PIN) == (200, {})
    assert board.ask(path, "POST", order="say", text="Look from the side.") == (200, {})
    assert simulator.served.presenter.calls == [
        ("instruct", "pause", ""),
        ("instruct", "say", "Look from the side."),
    ]
    simulator.served.presenter.problem = "Nothing is running."
    assert board.ask(path, "POST", order="pause") == (409, "Nothing is running.")


def test_only_a_paired_teacher_gives_orders_or_changes_the_board(board, simulator):
    seat = board.add(simulator)
    for path in ("/tiles", "/paired", f"/seat/{seat}/", f"/seat/{seat}/role"):
        assert board.ask(path, key="x" * 40)[0] == 401
    assert board.ask("/seats", "POST", key="x" * 40, name="Door")[0] == 401
    assert board.ask(f"/seat/{seat}", "DELETE", key="x" * 40)[0] == 401
    headers = {"Authorization": f"Bearer {board.key}", "Origin": "https://elsewhere.example"}
    for path, method in (("/seats", "POST"), (f"/seat/{seat}", "DELETE"), ("/tiles", "GET")):
        assert request(board.url, path, method, headers=headers)[0] == 403
    key = board.paired("spectator")
    assert len(board.tiles_until(is_watching, key)) == 1
    assert board.ask(f"/seat/{seat}/role", key=key) == (200, {"role": "spectator"})
    for path, method in ((f"/seat/{seat}", "DELETE"), (f"/seat/{seat}/order", "POST")):
        assert board.ask(path, method, key=key, order="pause", pin=PIN)[0] == 403
    assert board.ask("/seats", "POST", key=key, name="Door")[0] == 403
    assert simulator.served.presenter.calls == []


def live(board, seat, first):
    """Return what a page of a seat is sent until it has a state, or why it was closed."""

    async def read():
        headers = {"Authorization": f"Bearer {board.key}"}
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(
                f"{board.url}/seat/{seat}/stream", protocols=["rastrainer.views.1"], headers=headers
            ) as socket,
        ):
            await socket.send_str(json.dumps(first))
            await socket.send_str(json.dumps({"type": "press", "control": "touch"}))
            kinds = []
            while "state" not in kinds:
                message = await socket.receive()
                if message.type is not aiohttp.WSMsgType.TEXT:
                    return message.extra
                kinds.append(json.loads(message.data)["type"])
            return kinds

    return board.thread.run(read())


def test_a_seat_is_seen_and_heard_live_and_no_input_of_its_page_reaches_it(board, simulator):
    seat = board.add(simulator)
    kinds = live(board, seat, SPECTATOR)
    assert {"welcome", "screen", "state"} <= set(kinds)
    assert "pairing" not in kinds
    refused = "This stream is only for watching: the first message must be a spectator's hello."
    assert live(board, seat, HELLO) == refused
    assert simulator.served.presenter.calls == []
    headers = {"Authorization": f"Bearer {board.key}"}
    status, found, content = request(board.url, f"/seat/{seat}/sounds/touch.wav", headers=headers)
    assert (status, found["Content-Type"], content[:4]) == (200, "audio/wav", b"RIFF")
    for path in (
        "scene/" + 64 * "0" + ".glb",
        "scenarios/none.png",
        "instructor",
        "pair",
        "../role",
    ):
        assert request(board.url, f"/seat/{seat}/{path}", headers=headers)[0] in (404, 405)


def checked_seat(values: dict) -> dict:
    """Return what a board shows of what a simulator reports."""
    return record_to_json(record_from_json(SeatNews, values, "The seat"), with_defaults=True)


def good_seat() -> dict:
    reported = {"phase": "running", "touched": 3, "rejected": 1, "elapsedS": 70, "touch": "near"}
    return record_to_json(AT_WORK, with_defaults=True) | reported


def test_a_seat_that_sends_invalid_values_is_not_shown():
    assert checked_seat(good_seat()) == good_seat()
    for name, value in (
        ("trainee", "\x1b[2J"),
        ("count", 10**9),
        ("warnings", ["x" * 601]),
        ("touch", "<b>"),
    ):
        with pytest.raises(ValueError, match=f"The seat: {name}.* must be"):
            checked_seat({**good_seat(), name: value})
    shown = checked_seat({**good_seat(), "warnings": [str(n) for n in range(1000)], "new": 1})
    assert (len(shown["warnings"]), "new" in shown) == (8, False)


def test_a_damaged_list_of_seats_is_named(tmp_path):
    (tmp_path / SEATS_FILE).write_text('{"seats": [{"id": "../../x"}]}', encoding="utf-8")
    with pytest.raises(ValueError, match=SEATS_FILE):
        read_seats(tmp_path)
