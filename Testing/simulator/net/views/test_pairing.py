import json
import logging

import pytest

from rastrainer_simulator.net.views import access_control
from rastrainer_simulator.net.views import view_server as view_server_module
from rastrainer_simulator.net.views.access_control import COOKIE, PairingCode, Sessions
from rastrainer_simulator.presentation.messages import ViewRole
from Testing.simulator.net.views.served import SUBPROTOCOL, raw_request, request

UPGRADE = {
    "Connection": "Upgrade",
    "Upgrade": "websocket",
    "Sec-WebSocket-Version": "13",
    "Sec-WebSocket-Key": "AAAAAAAAAAAAAAAAAAAAAA==",
    "Sec-WebSocket-Protocol": SUBPROTOCOL,
}
SCENE = f"/scene/{'0' * 64}.glb"
PROTECTED = (SCENE, "/sounds/touch.wav", "/stream", "/anything")


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


def pair(served, code, **headers):
    return request(served.url, "/pair", "POST", json={"code": code}, headers=headers)


def wrong(code: str) -> str:
    return f"{(int(code) + 1) % 10**6:06d}"


def test_without_a_key_nothing_can_be_seen(served):
    for path in PROTECTED:
        for headers in ({}, bearer("x" * 43), {"Cookie": f"{COOKIE}=x"}, bearer("é" * 40)):
            status, _, body = request(served.url, path, headers={**UPGRADE, **headers})
            assert (status, b"Pair first" in body) == (401, True)


def test_the_pairing_code_gives_a_key_and_a_cookie_that_scripts_cannot_read(served):
    status, headers, body = pair(served, served.code)
    assert status == 200
    cookie = headers["Set-Cookie"]
    assert {"HttpOnly", "SameSite=Strict", "Path=/"} <= set(cookie.split("; "))
    key = cookie.split(";")[0].partition("=")[2]
    assert key.encode() in body
    for headers in (bearer(key), {"Cookie": f"{COOKIE}={key}"}):
        assert request(served.url, "/sounds/touch.wav", headers=headers)[0] == 200


def test_five_wrong_codes_create_a_new_one_and_start_a_pause(served):
    served.server.code._clock = lambda: 100.0
    first = served.code
    for _ in range(4):
        assert pair(served, wrong(first))[0] == 403
    status, headers, body = pair(served, wrong(first))
    assert (status, int(headers["Retry-After"])) == (429, 1)
    assert b"new code" in body
    assert served.new_codes == [served.code]
    status, headers, _ = pair(served, served.code)
    assert (status, int(headers["Retry-After"])) == (429, 1)


def test_a_view_on_this_computer_shows_how_to_pair_others(served, connect):
    view = connect(served)
    view.join()
    message = {"type": "pairing", "code": served.code, "addresses": [served.url]}
    assert view.next("pairing") == message
    for _ in range(5):
        pair(served, wrong(served.code))
    assert view.next("pairing") == {**message, "code": served.new_codes[0]}


def test_the_pause_ends_and_grows_to_five_minutes_until_the_right_code_is_entered():
    now, shown = [0.0], []
    code = PairingCode(lambda: now[0], shown.append)
    for pause in (1.0, 2.0, 4.0):
        for _ in range(5):
            assert not code.accepts(wrong(code.code))
        assert code.seconds_to_wait() == pause
        now[0] += pause
        assert code.seconds_to_wait() == 0.0
    assert len(shown) == 3
    for _ in range(50):
        code.accepts(wrong(code.code))
    assert code.seconds_to_wait() <= 300.0
    assert code.accepts(code.code)
    for _ in range(5):
        code.accepts(wrong(code.code))
    assert code.seconds_to_wait() == 1.0


def test_a_key_keeps_the_role_it_was_issued_for(served):
    for role in ("view", "spectator"):
        body = {"code": served.code, "role": role}
        headers = request(served.url, "/pair", "POST", json=body)[1]
        cookie = {"Cookie": headers["Set-Cookie"].split(";")[0]}
        status, _, answer = request(served.url, "/role", headers=cookie)
        assert (status, json.loads(answer)) == (200, {"role": role})
    assert request(served.url, "/role")[0] == 401


def test_a_body_without_code_and_role_is_refused_and_costs_no_attempt(served):
    for role in ("teacher", "", 1, None, ["view"]):
        body = {"code": served.code, "role": role}
        status, _, answer = request(served.url, "/pair", "POST", json=body)
        assert (status, b"spectator" in answer) == (400, True)
    for body in (b"", b"{", b"[]", b'{"code": 1}', b'{"code": ""}', b"\xff", b'{"code": NaN}'):
        assert request(served.url, "/pair", "POST", data=body)[0] == 400
    assert request(served.url, "/pair", "POST", data=b"1" * 100_000)[0] == 413
    assert served.new_codes == []


def test_codes_and_keys_are_never_logged(served, caplog):
    caplog.set_level(logging.DEBUG)
    codes = [served.code]
    key = pair(served, served.code)[1]["Set-Cookie"].split(";")[0].partition("=")[2]
    request(served.url, SCENE, headers=bearer(key))
    for _ in range(5):
        codes.append(wrong(served.code))
        pair(served, codes[-1])
    codes.append(served.code)
    assert "wrong pairing codes" in caplog.text
    assert not any(secret in caplog.text for secret in (key, *codes))


def test_a_page_from_another_origin_can_neither_pair_nor_connect(served):
    key = served.new_key()
    for origin in ("http://evil.example", f"https://127.0.0.1:{served.port}", "null"):
        assert pair(served, served.code, Origin=origin)[0] == 403
        headers = {**UPGRADE, **bearer(key), "Origin": origin}
        assert request(served.url, "/stream", headers=headers)[0] == 403
    assert pair(served, served.code, Origin=served.url)[0] == 200


def test_a_foreign_host_name_that_leads_here_is_refused_and_our_own_are_accepted(served):
    for host in ("evil.example", "evil.example:80", "", "localhost.evil.example"):
        origin = f"http://{host}"
        assert pair(served, served.code, Host=host, Origin=origin)[0] in (400, 403)
    for host in ("localhost", "LOCALHOST:1", "[::1]:80", "127.0.0.1"):
        assert pair(served, served.code, Host=host)[0] == 200


def test_every_answer_tells_the_browser_what_to_block(served):
    for path in ("/", SCENE, "/missing"):
        headers = request(served.url, path)[1]
        policy = headers["Content-Security-Policy"].split("; ")
        assert {"default-src 'self'", "object-src 'none'", "frame-ancestors 'none'"} <= set(policy)
        assert headers["Referrer-Policy"] == "no-referrer"
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Cross-Origin-Resource-Policy"] == "same-origin"


@pytest.fixture
def page(tmp_path, monkeypatch):
    """A built page; a private file is next to its folder."""
    folder = tmp_path / "page"
    folder.mkdir()
    (folder / "index.html").write_text("<title>built</title>")
    (folder / "page.js").write_text("export {};")
    (tmp_path / "secret.txt").write_text("secret")
    (folder / "link.txt").symlink_to(tmp_path / "secret.txt")
    monkeypatch.setattr(view_server_module, "page_folder", lambda: folder)


@pytest.mark.usefixtures("page")
def test_the_built_page_is_served_to_everyone_and_no_path_leads_out_of_its_folder(served):
    assert b"built" in request(served.url, "/")[2]
    status, headers, _ = request(served.url, "/page.js")
    assert status == 200
    assert headers["Content-Type"].split(";")[0].endswith("/javascript")
    for path in (
        *("/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/..\\secret.txt"),
        *("//secret.txt", "/link.txt", "/page.js/../../secret.txt", "/sounds/../secret.txt"),
        "/scene/..%2f..%2fsecret.txt.glb",
    ):
        answer = raw_request(served.port, f"GET {path} HTTP/1.1")
        assert answer.split(b" ")[1] in (b"400", b"401", b"403", b"404")
        assert b"secret" not in answer.partition(b"\r\n\r\n")[2]


def test_spectators_never_displace_the_key_of_a_view(monkeypatch):
    monkeypatch.setattr(access_control, "MAX_SESSIONS", 2)
    sessions = Sessions()
    key = sessions.open()
    watching = [sessions.open(ViewRole.SPECTATOR) for _ in range(3)]
    assert sessions.role(key) is ViewRole.VIEW
    assert [sessions.role(each) for each in watching] == [
        None,
        ViewRole.SPECTATOR,
        ViewRole.SPECTATOR,
    ]
