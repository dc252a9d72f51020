"""Without the pairing code nothing is seen or driven, over loopback and the local network alike."""

from __future__ import annotations

import json
import re
import stat
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Command
from rastrainer.igtl.message import Message, pack
from Testing.web.chromium import PATIENCE_MS, SMALL, draw_nothing, open_page
from Testing.web.hands import PageKeys
from Testing.web.place import PATIENT, Place

NETWORK = re.compile(r"serves the local network on (https://\S+?:\d+)")
TRY_TO_COMMAND = """([url, bytes]) =>
  fetch(url, { method: "POST", mode: "no-cors", body: new Uint8Array(bytes) })
    .then(() => "answered", () => "refused")
"""
TRY_TO_JOIN = """(url) => new Promise((done) => {
  const socket = new WebSocket(url + "/stream", "rastrainer.views.1");
  socket.onopen = () => done("joined");
  socket.onerror = () => done("refused");
})"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("security")
    with Place(folder, "--lan", limits=PATIENT) as place:
        place.network = NETWORK.search(place.simulator.next_line())[1]
        place.cable = place.simulator.next_line()
        yield place


@pytest.fixture
def stranger(browser):
    context = browser.new_context(viewport=SMALL, ignore_https_errors=True)
    page = context.new_page()
    draw_nothing(page)
    page.set_default_timeout(PATIENCE_MS)
    yield page
    context.close()


@pytest.mark.parametrize("way", ["loopback", "network"])
def test_who_has_not_paired_sees_the_form_and_nothing_else(place, stranger, way):
    url = place.simulator.url if way == "loopback" else place.network
    stranger.goto(url)
    stranger.wait_for_selector("#pairing:not([hidden])")
    assert stranger.evaluate(TRY_TO_JOIN, url.replace("http", "ws", 1)) == "refused"
    assert stranger.evaluate("fetch('/sounds/touch.wav').then((a) => a.status)") == 401
    stranger.fill("#code", "000000" if place.simulator.code != "000000" else "111111")
    stranger.press("#code", "Enter")
    stranger.wait_for_selector("#pairing output:not(:empty)")
    stranger.fill("#code", place.simulator.code)
    stranger.press("#code", "Enter")
    stranger.wait_for_selector("body[data-scene]")
    assert stranger.evaluate("window.isSecureContext")
    # Only the views of this computer are told how others are paired.
    if way == "loopback":
        stranger.wait_for_selector(f"#status:has-text('{place.simulator.code}')")
    told = stranger.inner_text("#status")
    assert (place.simulator.code in told, place.network in told) == (way == "loopback",) * 2


@pytest.fixture(scope="module")
def foreign_url():
    """Where a page of somebody else is served, on this computer, too."""

    class Foreign(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.end_headers()

        def log_message(self, *_arguments):
            pass

    server = HTTPServer(("127.0.0.1", 0), Foreign)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


def test_a_page_of_another_origin_cannot_connect(place, browser, foreign_url):
    own = open_page(browser, place.simulator.url, place.simulator.code, draws=False)
    foreign = own.context.new_page()
    foreign.goto(foreign_url)
    assert foreign.evaluate(TRY_TO_JOIN, place.simulator.url.replace("http", "ws", 1)) == "refused"
    own.context.close()


def test_a_page_cannot_send_commands_to_the_openigtlink_port(place, stranger, foreign_url):
    arguments = {"task": "task-1", "trainee": "somebody-else"}
    command = pack(Message("command", Command(1, "StartTask", json.dumps(arguments))))
    stranger.goto(foreign_url)
    port = place.simulator.port
    answer = stranger.evaluate(TRY_TO_COMMAND, [f"http://127.0.0.1:{port}", list(command)])
    assert answer == "refused"
    with Client(port=port) as client:
        state = client.wait_for("SimState", timeout=60)
    assert "somebody-else" not in state.content.text


def test_a_code_in_the_address_does_not_stay_there(place, stranger):
    code = "000000" if place.simulator.code != "000000" else "111111"
    stranger.goto(f"{place.simulator.url}/#code={code}")
    stranger.wait_for_selector("#pairing:not([hidden])")
    assert stranger.url == f"{place.simulator.url}/"
    assert stranger.evaluate("[location.hash, history.length]") == ["", 2]


def test_a_second_operator_cannot_take_the_control_unasked(place, browser):
    pages = [
        open_page(browser, place.simulator.url, place.simulator.code, draws=False) for _ in range(2)
    ]
    first = place.trainee(PageKeys(pages[0]))
    first.choose("train")
    # Whoever rests may be relieved, and a slow machine would let them rest: when the focus has
    # moved, the simulator knows of the key that was pressed before.
    pages[0].keyboard.down("ShiftLeft")
    focus = first.menu.focus
    first.press("down", lambda: first.menu.focus != focus, "another focus")
    pages[1].keyboard.press("Escape")
    pages[1].wait_for_selector("#warnings li[data-tone=warning]")
    # The warning has come with the menu that is open now.
    assert pages[1].get_attribute("body", "data-menu") == "introduction"
    pages[0].wait_for_selector("#control:has-text('You drive')")
    assert not pages[1].evaluate("page.control.isYou")
    for page in pages:
        page.context.close()


def test_the_private_key_is_the_owners_alone_and_a_cable_is_told(place):
    file = place.records.with_name("records-config") / "certificates" / "views.pem"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert "adb reverse tcp:" in place.cable
