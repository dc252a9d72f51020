import asyncio
import hashlib

import numpy as np
import pytest
from trimesh.transformations import quaternion_matrix

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.presentation.messages import Feedback, Hello
from rastrainer_simulator.presentation.presenter import Control
from rastrainer_simulator.presentation.screen import (
    Hint,
    Menu,
    MenuItem,
    Screen,
    ScreenMessage,
    Tone,
)
from Testing.domain.scenario.made_up_scenario import png
from Testing.simulator.net.views.served import request

BODIES = [*(f"link_{joint}" for joint in range(8)), "tool", "head", "stand", "plan"]
SCREEN = Screen(
    menu=Menu("start", "RASTrainer", items=(MenuItem("go", "Begin"),), focus="go"),
    instruction=ScreenMessage("Touch 3", Tone.GOOD),
    hints=(Hint("A", "Touch"),),
)


def feedback(number: int) -> Feedback:
    return Feedback(number, "touch", "touch", rumble=0.5, rumble_ms=120)


def test_a_view_is_welcomed_first_and_sent_the_current_state(served, connect):
    served.presenter.screen = SCREEN
    served.presenter.control = Control("gamepad")
    view = connect(served)
    assert view.join() == {"type": "welcome", "protocol": 1, "view": 1, "bodies": BODIES}
    seen = {message["type"]: message for message in view.all_until(lambda m: m["type"] == "state")}
    assert seen["control"] == {"type": "control", "holder": "gamepad", "isYou": False}
    screen = seen["screen"]["screen"]
    assert screen["menu"]["items"][0]["name"] == "go"
    assert screen["instruction"] == {"text": "Touch 3", "tone": "good"}
    assert screen["hints"] == [{"control": "A", "action": "Touch", "item": ""}]
    assert ("view_joined", 1, Hello("page", "Quest 2", 72.0)) in served.presenter.calls


def test_poses_match_those_of_the_simulation(served, connect, control_loop):
    view = connect(served)
    view.join()
    state = view.next("state")
    now = control_loop.latest
    matrices = [*now.link_to_world, now.tool_tip_to_world, now.head_to_world, now.stand_to_world]
    matrices.append(np.eye(4))
    assert len(state["poses"]) == len(BODIES)
    for (x, y, z, qx, qy, qz, qw), expected in zip(state["poses"], matrices, strict=True):
        pose = quaternion_matrix([qw, qx, qy, qz])
        pose[:3, 3] = x, y, z
        assert pose == pytest.approx(expected, abs=3e-6)
    assert state["clearanceMm"] == pytest.approx(1000 * now.clearance, abs=1e-3)
    assert (state["phase"], state["next"], state["touched"]) == ("idle", None, [])
    assert state["camera"] == "close-up"


def test_the_scene_is_named_after_its_content_and_fits_the_scenario(served, connect, scenario):
    view = connect(served)
    view.join()
    scene = view.next("scene")
    headers = {"Authorization": f"Bearer {served.new_key()}"}
    status, answer, glb = request(served.url, scene["url"], headers=headers)
    assert (status, answer["Content-Type"]) == (200, "model/gltf-binary")
    assert "immutable" in answer["Cache-Control"]
    assert scene["url"] == f"/scene/{hashlib.sha256(glb).hexdigest()}.glb"
    assert (scene["task"], scene["fiducials"]) == ("", {})
    for name, camera in scenario.cameras.items():
        assert scene["cameras"][name]["position"] == pytest.approx(camera.position_mm / MM_PER_M)
        assert scene["cameras"][name]["viewAngleDeg"] == camera.view_angle_deg


def test_a_scene_is_half_as_large_with_gzip_and_announces_its_size(served, connect):
    view = connect(served)
    view.join()
    url = view.next("scene")["url"]
    key = {"Authorization": f"Bearer {served.new_key()}"}
    headers, whole = request(served.url, url, headers={**key, "Accept-Encoding": "identity"})[1:]
    assert int(headers["Content-Length"]) == len(whole)
    headers, unpacked = request(served.url, url, headers={**key, "Accept-Encoding": "gzip"})[1:]
    assert (headers["Content-Encoding"], headers["Vary"]) == ("gzip", "Accept-Encoding")
    assert unpacked == whole
    assert int(headers["X-File-Size"]) == len(whole)
    assert int(headers["Content-Length"]) < 0.6 * len(whole)


def test_every_view_gets_each_event_once_and_in_order(served, connect):
    views = [connect(served) for _ in range(3)]
    for view in views:
        view.join()
        view.next("state")
    for number in range(1, 201):
        served.tell(feedback(number))
    for view in views:
        events = [view.next("event") for _ in range(200)]
        assert [event["number"] for event in events] == list(range(1, 201))
    assert events[2] == {
        "type": "event",
        "number": 3,
        "kind": "touch",
        "sound": "touch",
        "volume": 1.0,
        "rumble": 0.5,
        "rumbleMs": 120,
    }


def test_a_view_that_falls_behind_gets_the_latest_screen_and_not_all_before_it(serve, connect):
    served = serve(gone_s=1000.0)
    view = connect(served)
    view.join()
    view.next("state")
    text, count = "x" * 20_000, 400
    for number in range(count):
        served.tell(Screen(instruction=ScreenMessage(f"{number} {text}")))

    def is_last(message):
        return str(message.get("screen")).find(f"{count - 1} {text}") >= 0

    messages = view.all_until(is_last)
    screens = [message for message in messages if message["type"] == "screen"]
    assert len(screens) < count / 2, "what no client read was replaced, not queued"


def test_a_view_that_no_longer_reads_does_not_hold_up_the_shutdown(serve, connect):
    served = serve(gone_s=1000.0)
    view = connect(served)
    view.join()
    view.next("state")
    handlers = served.server._http._runner.server.connections

    def is_held_up():
        return any(each.transport.get_write_buffer_size() > 0 for each in handlers)

    text, held_up = "x" * 20_000, 0
    while held_up < 100:
        served.tell(Screen(instruction=ScreenMessage(f"{held_up} {text}")))
        served.thread.run(asyncio.sleep(0.005))
        held_up = held_up + 1 if served.thread.call(is_held_up) else 0
    served.close()


def test_a_view_that_lets_too_many_events_wait_is_dropped_and_may_come_back(served, connect):
    view, other = connect(served), connect(served)
    for one in (view, other):
        one.join()
        one.next("state")
    served.tell(*(feedback(number) for number in range(1, 300)))
    code, reason = view.closing()
    assert (code, reason) == (1013, "The view has not read its events; it may come back.")
    again = connect(served)
    again.join()
    served.tell(feedback(300))
    assert again.next("event")["number"] == 300


def test_a_scenarios_picture_is_served_to_views_by_name_and_nothing_else_is(served, tmp_path):
    picture = tmp_path / "preview.png"
    picture.write_bytes(png())
    served.pictures["ball"] = picture
    key = {"Authorization": f"Bearer {served.new_key()}"}
    status, headers, body = request(served.url, "/scenarios/ball.png", headers=key)
    assert (status, headers["Content-Type"], body) == (200, "image/png", png())
    assert request(served.url, "/scenarios/ball.png")[0] == 401
    for path in ("/scenarios/none.png", "/scenarios/..%2Fball.png", "/scenarios/Ball.png"):
        assert request(served.url, path, headers=key)[0] == 404
    picture.unlink()
    assert request(served.url, "/scenarios/ball.png", headers=key)[0] == 404
