"""Each message of the simulator and its views is read as it was written."""

from __future__ import annotations

import json

import pytest

from rastrainer.json_records import record_from_json
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.net.views.outgoing import BODIES, GHOST_BODIES, scene_news, state_news
from rastrainer_simulator.presentation.messages import (
    INPUTS,
    PROTOCOL,
    Alive,
    ControlNews,
    CoveringBodies,
    Feedback,
    Frames,
    HeadsetInput,
    Hello,
    ItemInput,
    KeyInput,
    LayoutInput,
    News,
    OrbitInput,
    PadInput,
    PairingNews,
    PictureProgress,
    PressInput,
    ScreenNews,
    SkinPlace,
    SticksInput,
    TextInput,
    TraceNews,
    Visibility,
    WelcomeNews,
    message_text,
    read_view_input,
)
from rastrainer_simulator.presentation.screen import (
    DepthRuler,
    ErrorArrow,
    Fact,
    Hint,
    Menu,
    MenuItem,
    ScoreTrend,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.viewpoint.view_control import CameraPose, Pictures

CAMERA = CameraPose((0.5, -0.5, 0.4), (0.5, 0.0, 0.25), (0.0, 0.0, 1.0), 30.0)
SCREEN = Screen(
    menu=Menu(
        "result",
        "Résultat",
        ("12\N{NARROW NO-BREAK SPACE}mm",),
        (Fact("Time", "3:21", Tone.GOOD),),
        (MenuItem("again", "Again", is_enabled=False),),
        trend=ScoreTrend("Scores", (20.0, 80.0), 70.0),
    ),
    warnings=(ScreenMessage("Beware", Tone.WARNING),),
    hints=(Hint("A", "Touch", "press touch"),),
    errors=(ErrorArrow((0.1, 0.2, 0.3), (0.1, 0.2, 0.4), Tone.ERROR, "Nasion"),),
    ruler=DepthRuler(30.0, None, 45.0, 126.0, ("Entry", "Outer", "Inner", "Target")),
)
SENT = (
    WelcomeNews(PROTOCOL, 7, BODIES),
    ScreenNews(SCREEN),
    Feedback(1, "touch", "touch", 0.5, 0.5, 120),
    ControlNews("gamepad", False),
    PairingNews("123456", ("https://192.0.2.7:18946",)),
    TraceNews(0, ((1.0, 2.0, 3.0),), 10.0, SkinPlace((1.0, 80.0, -20.0), (0.0, 1.0, 0.0))),
)
RECEIVED = (
    Hello("headset", "Meta Quest 3", 90.0),
    KeyInput("KeyW", True, "w"),
    LayoutInput({"KeyA": "q"}),
    PadInput((0.5, -1.0), (0.0, 1.0)),
    SticksInput((0.0, 1.0, 0.0), (0.0, -1.0), True, 90.0),
    OrbitInput(10.0, -5.0, 0.9),
    PressInput("touch"),
    ItemInput("again"),
    TextInput("trainee", ""),
    PictureProgress("", 0.5),
    Frames(60, 1, 72.0),
    Visibility(False),
    HeadsetInput((0.5, -0.6, 1.25, 0.0, 0.6, 0.0, 0.8), None, None),
    Alive(),
)


@pytest.fixture(scope="module")
def sent(setup):
    """Messages of each type that a view is sent."""
    now = Simulation(setup, seed=4).state
    ghost = [now.tool_tip_to_world] * len(GHOST_BODIES)
    covering = CoveringBodies(view=("link_5",))
    scene = scene_news("0" * 64, setup.scenario, "task-1", AxesChoice.CAMERA)
    return (*SENT, scene, state_news(now, 3, Pictures(CAMERA, CAMERA), covering, ghost))


def test_every_message_to_a_view_is_read_as_it_was_sent(sent):
    assert {type(message) for message in sent} == set(News.__subclasses__())
    for message in sent:
        values = json.loads(message_text(message))
        assert values.pop("type") == message.type
        assert record_from_json(type(message), values, only_known=True) == message


def test_every_message_of_a_view_is_read_as_it_was_sent():
    assert {message.type for message in RECEIVED} == set(INPUTS)
    for message in RECEIVED:
        assert read_view_input(message_text(message)) == message
