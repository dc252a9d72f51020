import asyncio
import contextlib
import json
import socket

import aiohttp
import pytest

from rastrainer_simulator.net.views import guarded_server, view_socket
from rastrainer_simulator.net.views import view_server as view_server_module
from Testing.simulator.net.igtl.servers import HOST
from Testing.simulator.net.views.served import HELLO

KEY = {"type": "key", "code": "KeyW", "isDown": True, "text": "w"}


def changed(message: dict, **changes) -> str:
    return json.dumps({**message, **changes})


STICKS = {
    "type": "sticks",
    "translation": [0, 0, 0],
    "rotation": [0, 0],
    "fine": False,
    "yawDeg": 0,
}
WORN = {"type": "headsetPose", "eyes": None, "left": None, "right": None}
GARBAGE = {
    "no JSON": "{",
    "binary": b"\x00\x01",
    "deep": "[" * 8000,
    "long number": '{"type":' + "1" * 8000 + "}",
    "lone surrogate": '{"type":"\\ud800"}',
    "type is a list": '{"type":["key"]}',
    "second hello": json.dumps(HELLO),
    "member missing": '{"type":"key","code":"KeyW"}',
    "NaN": '{"type":"pad","axes":[NaN],"buttons":[]}',
    "too many axes": json.dumps({"type": "pad", "axes": [0] * 17, "buttons": []}),
    "stick out of range": changed(STICKS, translation=[0, 0, 1.1]),
    "stick is true": changed(STICKS, rotation=[True, 0]),
    "text has a line feed": changed(KEY, text="\n"),
    "too many keys": json.dumps(
        {"type": "layout", "keys": dict.fromkeys(map(str, range(81)), "q")}
    ),
    "a page wears nothing": json.dumps(WORN),
    "a hand is not turned": changed(WORN, left=[0] * 7),
}


def test_an_invalid_or_oversized_message_closes_only_that_view(served, connect):
    good = connect(served)
    good.join()
    for name, message in {**GARBAGE, "large": "x" * 20_000}.items():
        bad = connect(served)
        number = bad.join()["view"]
        bad.send(message)
        code, reason = bad.closing()
        assert code == (1009 if name == "large" else 1008), name
        assert name == "large" or reason.startswith(("A ", "The ", "Messages ")), name
        served.wait_for_call("view_left", number)
    assert good.next("state")["type"] == "state"
    assert not any(call[0].startswith("on_") for call in served.presenter.calls)


@pytest.mark.parametrize("sends_pings", [False, True])
def test_a_flood_closes_only_that_view(served, connect, monkeypatch, sends_pings):
    monkeypatch.setattr(view_socket, "MESSAGES_PER_S", 2.0)
    good, bad = connect(served), connect(served)
    good.join()
    bad.join()
    with contextlib.suppress(ConnectionError):
        for _ in range(100):
            bad.ping() if sends_pings else bad.send({"type": "alive"})
    assert bad.closing()[0] == 1008
    assert good.next("state")["type"] == "state"


def test_a_ping_is_answered_but_does_not_keep_inputs_held(serve, connect):
    served = serve(silent_s=0.2)
    view = connect(served)
    number = view.join()["view"]
    view.send(KEY)
    served.wait_for_call("on_key", number, "KeyW", True, "w")
    while ("on_key", number, "KeyW", False, "") not in served.presenter.calls:
        view.ping()
        served.thread.run(asyncio.sleep(0.02))
    assert view.next("state")["type"] == "state"


def test_a_view_that_does_not_begin_with_hello_is_sent_nothing(served, connect, monkeypatch):
    bad = ({"kind": "hologram"}, {"device": "x" * 81}, {"refreshHz": -1})
    for message in ("{", b"hello", '{"type":"alive"}', *({**HELLO, **one} for one in bad)):
        view = connect(served)
        view.send(message)
        assert view.closing()[0] == 1008
    monkeypatch.setattr(view_server_module, "FIRST_MESSAGE_S", 0.05)
    assert connect(served).closing()[0] == 1008
    assert served.presenter.calls == []


def asking(port: int, path: str) -> socket.socket:
    """Return a connection that asks for a file, and does not read it."""
    stranger = socket.create_connection((HOST, port), 60)
    stranger.sendall(f"GET {path} HTTP/1.1\r\nHost: {HOST}:{port}\r\n\r\n".encode())
    assert stranger.recv(12) == b"HTTP/1.1 200"
    return stranger


def test_strangers_that_send_requests_and_never_read_keep_nobody_out(
    serve, connect, tmp_path, monkeypatch, caplog
):
    (tmp_path / "index.html").write_text("the page")
    (tmp_path / "page.js").write_bytes(bytes(20_000_000))
    monkeypatch.setattr(view_server_module, "page_folder", lambda: tmp_path)
    monkeypatch.setattr(guarded_server, "MAX_CONNECTIONS", 3)
    served = serve()
    paired = connect(served)
    paired.join()
    with contextlib.ExitStack() as stack:
        strangers = [stack.enter_context(asking(served.port, "/page.js")) for _ in range(2)]
        for stranger in strangers:
            connect(served).join()
            while stranger.recv(1_000_000):
                pass
        with pytest.raises(aiohttp.ClientError):
            connect(served)
    assert paired.next("state")["type"] == "state"
    assert caplog.text == ""


STRANGE_REQUESTS = [
    b"\x00\xff garbage\r\n\r\n",
    b"GET / HTTP/9.9\r\n\r\n",
    b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\n\r\n",
    b"GET / HTTP/1.1\r\nAuthorization: Bearer secret\x01\r\n\r\n",
    b"GET / HTTP/1.1\r\nTransfer-Encoding: chunked\r\nContent-Length: 3\r\n\r\nzz",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
    b"POST /pair HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 99999999999\r\n\r\n{}",
]


def test_an_invalid_request_is_refused_and_not_logged(served, caplog):
    for request_bytes in STRANGE_REQUESTS:
        with socket.create_connection((HOST, served.port), 60) as stranger:
            # It may be refused and cut off before it has sent everything.
            with contextlib.suppress(OSError):
                stranger.sendall(request_bytes)
                stranger.shutdown(socket.SHUT_WR)
            answer = b""
            with contextlib.suppress(ConnectionError):
                answer = stranger.recv(100)
        assert answer == b"" or answer.split(b" ")[1] in (b"400", b"413")
    assert caplog.text == ""
