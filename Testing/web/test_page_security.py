"""Without the pairing code nothing is seen or driven, over loopback and the local network alike."""

from __future__ import annotations

import re
import stat
import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from Testing.web.chromium import PATIENCE_MS, SMALL, open_page
from Testing.web.hands import PageKeys
from Testing.web.place import Place

NETWORK = re.compile(r"serves the local network on (https://\S+?:\d+)")
TRY_TO_JOIN = """(url) => new Promise((done) => {
  const socket = new WebSocket(url + "/stream", "rastrainer.views.1");
  socket.onopen = () => done("joined");
  socket.onerror = () => done("refused");
})"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("security"), "--lan") as place:
        place.network = NETWORK.search(place.simulator.next_line())[1]
        place.cable = place.simulator.next_line()
        yield place


@pytest.fixture
def stranger(browser):
    context = browser.new_context(viewport=SMALL, ignore_https_errors=True)
    page = context.new_page()
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


def test_a_page_of_another_origin_cannot_connect(place, browser):
    own = open_page(browser, place.simulator.url, place.simulator.code)

    class Foreign(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.end_headers()

        def log_message(self, *_arguments):
            pass

    server = HTTPServer(("127.0.0.1", 0), Foreign)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    foreign = own.context.new_page()
    foreign.goto(f"http://127.0.0.1:{server.server_port}")
    assert foreign.evaluate(TRY_TO_JOIN, place.simulator.url.replace("http", "ws", 1)) == "refused"
    server.shutdown()
    own.context.close()


def test_a_second_operator_cannot_take_the_control_unasked(place, browser):
    pages = [open_page(browser, place.simulator.url, place.simulator.code) for _ in range(2)]
    first = place.trainee(PageKeys(pages[0]))
    first.choose("train")
    pages[1].keyboard.press("Escape")
    pages[1].wait_for_selector("#warnings li[data-tone=warning]")
    assert first.menu.name == "introduction"
    pages[0].wait_for_selector("#control:has-text('You drive')")
    assert not pages[1].evaluate("page.control.isYou")
    for page in pages:
        page.context.close()


def test_the_private_key_is_the_owners_alone_and_a_cable_is_told(place):
    file = place.records.with_name("records-config") / "certificates" / "views.pem"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert "adb reverse tcp:" in place.cable
