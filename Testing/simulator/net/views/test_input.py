import asyncio

KEY = {"type": "key", "code": "KeyW", "isDown": True, "text": "w"}
PAD = {"type": "pad", "axes": [0.5, -1.0, 0, 0], "buttons": [0, 1, 0.25]}
STICKS = {
    "type": "sticks",
    "translation": [1, 0, -0.5],
    "rotation": [0, 0.5],
    "fine": True,
    "yawDeg": 90,
}

MESSAGES = [
    (KEY, ("on_key", "KeyW", True, "w")),
    ({"type": "layout", "keys": {"KeyA": "q"}}, ("on_layout", {"KeyA": "q"})),
    (PAD, ("on_pad", (0.5, -1.0, 0.0, 0.0), (0.0, 1.0, 0.25))),
    (
        {"type": "pad", "axes": [1.0001, -1.2], "buttons": [-0.001, 1.01]},
        ("on_pad", (1.0, -1.0), (0.0, 1.0)),
    ),
    (STICKS, ("on_sticks", (1.0, 0.0, -0.5), (0.0, 0.5), True, 90.0)),
    (
        {"type": "orbit", "aroundDeg": -12.5, "higherDeg": 3, "zoom": 0.9},
        ("on_orbit", -12.5, 3.0, 0.9),
    ),
    ({"type": "press", "control": "touch"}, ("on_press", "touch")),
    ({"type": "item", "name": "task-1"}, ("on_item", "task-1")),
    ({"type": "text", "name": "trainee", "value": "T 01"}, ("on_text", "trainee", "T 01")),
    (
        {"type": "frames", "shown": 72, "dropped": 1, "refreshHz": 72.0},
        ("on_frames", 72, 1, 72.0),
    ),
    ({"type": "picture", "task": "task-1", "share": 0.5}, ("on_picture", "task-1", 0.5)),
    ({"type": "visibility", "isVisible": False}, ("on_visibility", False)),
]


def test_what_a_view_sends_reaches_the_presenter(served, connect):
    view = connect(served)
    number = view.join()["view"]
    for message, (name, *values) in MESSAGES:
        view.send(message)
        served.wait_for_call(name, number, *values)


RELEASED = [
    (KEY, ("on_key", "KeyW", False, "")),
    (PAD, ("on_pad", (0.0,) * 4, (0.0,) * 3)),
    (STICKS, ("on_sticks", (0.0, 0.0, 0.0), (0.0, 0.0), False, 0.0)),
]


def test_inputs_held_by_a_view_that_falls_silent_are_released(serve, connect):
    served = serve(silent_s=0.05)
    view = connect(served)
    number = view.join()["view"]
    for message, (name, *values) in RELEASED:
        view.send(message)
        calls = served.wait_for_call(name, number, *values)
    assert ("view_left", number) not in calls, "it may go on watching"


def test_a_view_that_stops_reporting_frames_counts_as_a_frozen_picture(serve, connect):
    served = serve(lost_s=0.05)
    view = connect(served)
    number = view.join()["view"]
    view.send({"type": "frames", "shown": 60, "dropped": 0, "refreshHz": 60})
    calls = served.wait_for_call("on_silence", number)
    assert ("view_left", number) not in calls, "it may go on watching"


def test_inputs_held_by_a_view_that_reports_being_alive_stay_held(serve, connect):
    served = serve(silent_s=1000.0)
    view = connect(served)
    number = view.join()["view"]
    view.send(KEY)
    served.wait_for_call("on_key", number, "KeyW", True, "w")
    (joined,) = served.server._views._views.values()
    now = joined._clock()

    async def is_heard():
        while joined._last_message < now:
            await asyncio.sleep(0.001)

    # Time goes on only here: a sign of life may come late on a busy machine.
    joined._clock = lambda: now
    for _ in range(3):
        now += 900.0
        view.send({"type": "alive"})
        served.thread.run(is_heard())
        served.thread.call(joined.check_silence, 1000.0, 5000.0)
    assert ("on_key", number, "KeyW", False, "") not in served.presenter.calls
    now += 1001.0
    served.wait_for_call("on_key", number, "KeyW", False, "")


def test_a_view_that_leaves_releases_its_inputs_first(serve, connect):
    served = serve(silent_s=1000.0)
    view = connect(served)
    number = view.join()["view"]
    for message, _ in RELEASED:
        view.send(message)
    view.send({**KEY, "code": "KeyA"})
    view.send({**KEY, "code": "KeyA", "isDown": False})
    view.leave()
    calls = served.wait_for_call("view_left", number)
    released = [(name, number, *values) for _, (name, *values) in RELEASED]
    assert calls[-4:] == [*released, ("view_left", number)]


def test_no_view_holds_more_keys_than_hands_can(serve, connect):
    served = serve(silent_s=1000.0)
    view = connect(served)
    number = view.join()["view"]
    for index in range(100):
        view.send({**KEY, "code": f"Key{index}"})
    view.leave()
    calls = served.wait_for_call("view_left", number)
    assert sum(call[0] == "on_key" for call in calls) == 2 * 32
