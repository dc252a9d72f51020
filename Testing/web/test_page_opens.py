"""Opening and using the page: the pairing code, other origins, missing parts, keys and gamepads."""

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
from rastrainer_simulator.texts.texts import LANGUAGES
from Testing.end_to_end.hands import BrowserPad, PageKeys
from Testing.end_to_end.lab import Place
from Testing.web.chromium import (
    PATIENCE_MS,
    SMALL,
    draw_for_a_while,
    draw_nothing,
    open_page,
)

LARGEST_PAGE = 1_000_000
LARGEST_SCENE = 5_000_000
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

NOTE_LOADING = """
window.notes = [];
addEventListener("DOMContentLoaded", () => {
  const place = document.getElementById("loading");
  const note = () => {
    const bar = place.querySelector("progress");
    if (!place.hidden) notes.push([place.textContent, bar.value, bar.max]);
  };
  new MutationObserver(note).observe(place, { attributes: true, childList: true, subtree: true });
});
"""
"""The loading panel may be gone by the time it is checked."""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("opening")
    with Place(folder, "--lan", "--speed", "2") as place:
        place.network = NETWORK.search(place.simulator.next_line())[1]
        place.cable = place.simulator.next_line()
        yield place


def new_page(browser, **options):
    page = browser.new_context(viewport=SMALL, ignore_https_errors=True, **options).new_page()
    page.set_default_timeout(PATIENCE_MS)
    return page


@pytest.fixture
def stranger(browser):
    page = new_page(browser)
    draw_nothing(page)
    yield page
    page.context.close()


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(browser, place.url, place.code, has_pad=True, draws=False)
    yield page
    assert page.problems == []


@pytest.mark.parametrize("origin", ["loopback", "network"])
def test_an_unpaired_visitor_sees_the_form_alone_and_then_how_much_of_the_scene_has_loaded(
    place, stranger, origin
):
    stranger.add_init_script(NOTE_LOADING)
    url = place.url if origin == "loopback" else place.network
    stranger.goto(url)
    stranger.wait_for_selector("#pairing:not([hidden])")
    assert stranger.evaluate(TRY_TO_JOIN, url.replace("http", "ws", 1)) == "refused"
    assert stranger.evaluate("fetch('/sounds/touch.wav').then((a) => a.status)") == 401
    # However low the window is, the form can be scrolled to its last button.
    stranger.click("#pairing button.second", trial=True)
    stranger.fill("#code", "000000" if place.code != "000000" else "111111")
    stranger.press("#code", "Enter")
    stranger.wait_for_selector("#pairing output:not(:empty)")
    stranger.fill("#code", place.code)
    stranger.press("#code", "Enter")
    stranger.wait_for_selector("body[data-scene]")
    assert stranger.evaluate("window.isSecureContext")
    # Only the views of this computer learn how others are paired.
    if origin == "loopback":
        stranger.wait_for_selector(f"#status:has-text('{place.code}')")
    text = stranger.inner_text("#status")
    assert (place.code in text, place.network in text) == (origin == "loopback",) * 2
    stranger.wait_for_selector("#loading", state="hidden")
    notes = stranger.evaluate("notes")
    assert all(text.startswith("Loading the scene: ") for text, _loaded, _total in notes)
    (total,) = {total for _text, _loaded, total in notes}
    assert 1e6 < total < 5e6
    loaded = [loaded for _text, loaded, _total in notes]
    assert loaded == sorted(loaded)
    assert loaded[0] < loaded[-1] == total


@pytest.fixture(scope="module")
def foreign_url():
    """Where another program's page is served, also on this computer."""

    class ForeignHandler(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.end_headers()

        def log_message(self, *_arguments):
            pass

    server = HTTPServer(("127.0.0.1", 0), ForeignHandler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


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
    code = "000000" if place.code != "000000" else "111111"
    stranger.goto(f"{place.url}/#code={code}")
    stranger.wait_for_selector("#pairing:not([hidden])")
    assert stranger.url == f"{place.url}/"
    assert stranger.evaluate("[location.hash, history.length]") == ["", 2]


def test_the_private_key_is_readable_only_by_its_owner_and_a_cable_is_recommended(place):
    file = place.records.with_name("records-config") / "certificates" / "views.pem"
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert "adb reverse tcp:" in place.cable


def test_without_javascript_the_page_says_so_in_every_language(place, browser):
    page = new_page(browser, java_script_enabled=False)
    page.goto(place.url)
    assert page.inner_text("body").count("JavaScript") == len(LANGUAGES)
    page.context.close()


def address(place) -> str:
    return f"{place.url}/#code={place.code}"


WITHOUT_WEBGL = """
const { getContext } = HTMLCanvasElement.prototype;
HTMLCanvasElement.prototype.getContext = function (kind, ...options) {
  return kind.startsWith("webgl") ? null : getContext.call(this, kind, ...options);
};
"""


def test_without_webgl_menus_work_and_the_page_says_what_is_missing(place, browser):
    page = new_page(browser)
    page.add_init_script(WITHOUT_WEBGL)
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.goto(address(place))
    page.wait_for_selector("body[data-menu=start]")
    page.wait_for_selector("#warnings li:has-text('WebGL')")
    trainee = place.trainee(PageKeys(page))
    trainee.choose("settings")
    page.wait_for_selector("body[data-menu=settings]")
    assert page.inner_text("#menu h2") == trainee.menu.title
    assert problems == []
    page.context.close()


def test_a_second_operator_cannot_take_control_unasked(place, page, browser):
    other = open_page(browser, place.url, place.code, draws=False, has_scene=False)
    first = place.trainee(PageKeys(page))
    first.go_home()
    first.choose("train")
    # An idle view may lose control, and a slow machine would leave it idle: when the focus has
    # moved, the simulator knows of the key that was pressed before.
    page.keyboard.down("ShiftLeft")
    focus = first.menu.focus
    first.press("down", lambda: first.menu.focus != focus, "another focus")
    other.keyboard.press("Escape")
    other.wait_for_selector("#warnings li[data-tone=warning]")
    # The warning arrived with the menu that is open now.
    assert other.get_attribute("body", "data-menu") == "introduction"
    page.wait_for_selector("#control:has-text('You drive')")
    assert not other.evaluate("page.control.isYou")
    other.context.close()


def test_a_trial_is_begun_and_a_touch_undone_by_keyboard(place, page):
    trainee = place.carried_trainee(PageKeys(page))
    trainee.begin("task-1", page)
    page.wait_for_selector("body[data-scene=task-1]")
    page.wait_for_selector("#control:has-text('You drive: keyboard')")
    assert draw_for_a_while(page).std() > 20.0
    trainee.touch_all(1)
    trainee.press("undo", lambda: trainee.touched == 0, "the undo")


def test_a_second_gamepad_takes_the_place_of_an_idle_one_and_an_unknown_one_is_reported(
    place, page
):
    trainee = place.trainee(BrowserPad(page))
    trainee.go_home()
    page.evaluate(
        """() => {
          const idle = { ...structuredClone(pad), index: 0, axes: [0.12, 0, 0, 0] };
          window.pad.index = 1;
          navigator.getGamepads = () => [null, idle, window.pad]; }"""
    )
    before = trainee.menu.focus
    trainee.press("down", lambda: trainee.menu.focus != before, "a step")
    page.evaluate("window.pad.mapping = ''; navigator.getGamepads = () => [window.pad]")
    page.wait_for_selector("text=The browser does not know the layout of this gamepad")
    page.evaluate("window.pad.mapping = 'standard'; window.pad.index = 0")
    page.wait_for_selector("text=The browser does not know the layout", state="detached")


def test_the_page_is_smaller_than_a_megabyte_and_loads_nothing_from_elsewhere(place, page):
    own = (place.url, "data:")
    assert [url for url in page.loaded if not url.startswith(own)] == []
    scenes = [size for url, size in page.loaded.items() if url.endswith(".glb")]
    assert 0 < sum(page.loaded.values()) - sum(scenes) < LARGEST_PAGE
    assert 0 < max(scenes) < LARGEST_SCENE
