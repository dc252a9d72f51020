"""The instructor's PIN at a running simulator with two pages and a spectator."""

from __future__ import annotations

import json

import pytest

from rastrainer_simulator.ops.instructor_pin import InstructorPin
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient, request

PIN = "405816"


class Page:
    """A page that keeps all that it is sent."""

    def __init__(self, simulator, thread, role):
        pairing = {"code": simulator.code, "role": role}
        _status, _headers, body = request(simulator.url, "/pair", "POST", data=json.dumps(pairing))
        self._view = ViewClient(thread, simulator.url, json.loads(body)["key"])
        kind = "page" if role == "view" else role
        self.number = self._view.join(kind=kind)["view"]
        self.received: list[str] = []

    def send(self, **message):
        self._view.send(message)

    def tap(self, code):
        for is_down in (True, False):
            self.send(type="key", code=code, isDown=is_down, text="")

    def until(self, condition):
        """Read on until a screen is as wanted."""
        while True:
            message = json.loads(self._view.next_text())
            self.received.append(json.dumps(message, ensure_ascii=False))
            if message["type"] == "screen" and condition(message["screen"]):
                return message["screen"]

    def until_menu(self, name):
        return self.until(lambda screen: screen["menu"] and screen["menu"]["name"] == name)

    def choose(self, menu, item):
        self.until_menu(menu)
        self.send(type="item", name=item)


@pytest.fixture
def place(tmp_path):
    """Return a folder with a simulator's settings and records, the simulator, and a thread."""
    config = tmp_path / "records-config"
    InstructorPin(config).set(PIN)
    options = ["--view-port", "0", "--seed", "5"]
    with (
        LoopThread() as thread,
        ViewedSimulator(tmp_path / "records", *options) as simulator,
    ):
        yield tmp_path, simulator, thread


def test_a_pin_typed_in_one_page_appears_in_no_other_page_and_in_no_file(place):
    folder, simulator, thread = place
    page, other = (Page(simulator, thread, "view") for _ in range(2))
    spectator = Page(simulator, thread, "spectator")
    page.choose("start", "settings")
    settings = page.until_menu("settings")
    locked = {item["name"] for item in settings["menu"]["items"] if not item["isEnabled"]}
    assert {"order", "tutorial", "coarse", "guidance"} <= locked
    other.tap("KeyM")
    other.until(lambda screen: "Only an instructor can pass it on" in json.dumps(screen))
    page.send(type="item", name="unlock")
    dots = page.until_menu("pin")["menu"]["items"][0]["value"]
    assert dots == "_"
    page.send(type="item", name=PIN[0])
    for digit in PIN[1:]:
        page.tap(f"Digit{digit}")
    page.until(lambda screen: "••••••_" in json.dumps(screen, ensure_ascii=False))
    for unseeing in (other, spectator):
        menu = unseeing.until_menu("pin")["menu"]
        assert (menu["items"], menu["facts"], menu["focus"]) == ([], [], "")
    page.tap("Enter")
    opened = page.until_menu("settings")
    order = next(item for item in opened["menu"]["items"] if item["name"] == "order")
    assert order["isEnabled"]
    assert PIN not in "".join(page.received)
    for unseeing in (other, spectator):
        unseeing.until_menu("settings")
        text = "".join(unseeing.received)
        assert PIN not in text
        assert "•" not in text
    status, errors = simulator.stop()
    assert status == 0
    assert PIN not in errors
    written = [path for path in folder.rglob("*") if path.is_file()]
    assert "simulator-0.log" in {path.name for path in written}
    assert not [path for path in written if PIN.encode() in path.read_bytes()]
