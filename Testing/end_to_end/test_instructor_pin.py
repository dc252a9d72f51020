"""The instructor's PIN at a running simulator with two pages and a spectator."""

from __future__ import annotations

import json

import pytest

from rastrainer_simulator.ops.instructor_pin import InstructorPin
from Testing.end_to_end.simulator_process import MenuView, ViewedSimulator, items_of
from Testing.simulator.net.igtl.servers import LoopThread

PIN = "405816"


def tap(view, code):
    for is_down in (True, False):
        view.send({"type": "key", "code": code, "isDown": is_down, "text": ""})


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
    page, other = (MenuView(thread, simulator) for _ in range(2))
    spectator = MenuView(thread, simulator, "spectator")
    page.until_menu("start")
    settings = items_of(page.go("settings", "settings"))
    locked = {name for name, item in settings.items() if not item["isEnabled"]}
    assert {"order", "tutorial", "coarse", "guidance"} <= locked
    tap(other, "KeyM")
    other.until(lambda screen: "Only an instructor can pass it on" in json.dumps(screen))
    (dots, *_) = page.go("unlock", "pin")["items"]
    assert dots["value"] == "_"
    page.send({"type": "item", "name": PIN[0]})
    for digit in PIN[1:]:
        tap(page, f"Digit{digit}")
    page.until(lambda screen: "••••••_" in json.dumps(screen, ensure_ascii=False))
    for unseeing in (other, spectator):
        menu = unseeing.until_menu("pin")
        assert (menu["items"], menu["facts"], menu["focus"]) == ([], [], "")
    tap(page, "Enter")
    assert items_of(page.until_menu("settings"))["order"]["isEnabled"]
    assert PIN not in "".join(page.received)
    for unseeing in (other, spectator):
        unseeing.until_menu("settings")
        text = "".join(unseeing.received)
        assert PIN not in text
        assert "•" not in text
        assert "\\u2022" not in text
    status, errors = simulator.stop()
    assert status == 0
    assert PIN not in errors
    written = [path for path in folder.rglob("*") if path.is_file()]
    assert "simulator-0.log" in {path.name for path in written}
    assert not [path for path in written if PIN.encode() in path.read_bytes()]
