"""Messages of views: their names, and the check of everything that arrives.

docs/views.md says what each means.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    accepted,
    decode_message_object,
    number,
    numbers,
    one_of,
    text,
    whole_number,
    yes_or_no,
)

PROTOCOL = 1
SUBPROTOCOL = "rastrainer.views.1"

HELLO = "hello"
KEY = "key"
LAYOUT = "layout"
PAD = "pad"
STICKS = "sticks"
PRESS = "press"
ITEM = "item"
ORBIT = "orbit"
TEXT = "text"
FRAMES = "frames"
PICTURE = "picture"
VISIBILITY = "visibility"
ALIVE = "alive"
WORN = "worn"

DESKTOP = "desktop"
HEADSET = "headset"
SPECTATOR = "spectator"
BOARD = "board"
ONLY_WATCH = (SPECTATOR, BOARD)
"""The kinds that may only send that they are alive."""
VIEW_KINDS = (DESKTOP, "page", HEADSET, *ONLY_WATCH)
MAX_KEYS = 80
MAX_AXES = 16
MAX_BUTTONS = 32
# Pads go a little beyond their end; what is farther out is no position of a stick.
SLACK = 1.5
POSE_NUMBERS = 7
FARTHEST_M = 100.0
# How much the length of a rounded quaternion may differ from 1.
NEARLY_UNIT = 0.01


@dataclass(frozen=True)
class Received:
    """A message that has passed its check; `values` are in the order of its members."""

    type: str
    values: tuple[Any, ...]


Pose = tuple[float, ...]
"""x, y, z (m) and the unit quaternion qx, qy, qz, qw, in World."""


@dataclass(frozen=True)
class Worn:
    """Where a headset and its controllers are.

    Attributes:
        eyes: pose of the middle between the eyes, which look along −z with y up; None while nobody
            wears the headset.
        left, right: poses of the controllers, which point along −z; None where there is none.
    """

    eyes: Pose | None
    left: Pose | None
    right: Pose | None


def _maybe_empty(longest: int) -> Callable[[Any], str]:
    """Accept printable text of up to `longest` characters."""
    check = text(longest)
    return lambda value: "" if value == "" else check(value)


def _key_names(value: Any) -> Mapping[str, str]:
    """Accept the names of at most `MAX_KEYS` keys, of some letters each, by their W3C codes."""
    if not isinstance(value, dict) or len(value) > MAX_KEYS:
        raise ValueError(f"an object with at most {MAX_KEYS} names")
    check_code, check_name = text(32), text(8)
    return {check_code(code): check_name(name) for code, name in value.items()}


def _positions(most: int, lowest: float) -> Callable[[Any], tuple[float, ...]]:
    check_one = number(-SLACK, SLACK)

    def check(value: Any) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) > most:
            raise ValueError(f"a list of at most {most} numbers")
        return tuple(min(1.0, max(lowest, check_one(item))) for item in value)

    return check


def _pose_or_null(value: Any) -> Pose | None:
    """Accept x, y, z (m) and a unit quaternion qx, qy, qz, qw, or null."""
    if value is None:
        return None
    pose = numbers(POSE_NUMBERS, FARTHEST_M)(value)
    if abs(math.hypot(*pose[3:]) - 1.0) > NEARLY_UNIT:
        raise ValueError("a position (m) and a unit quaternion, or null")
    return pose


_RATE = number(0, 1000, "Hz")
_COUNT = whole_number(0, 10_000)

MEMBERS: Mapping[str, Mapping[str, Callable[[Any], Any]]] = {
    HELLO: {"kind": one_of(*VIEW_KINDS), "device": _maybe_empty(80), "refreshHz": _RATE},
    KEY: {"code": text(32), "isDown": yes_or_no, "text": _maybe_empty(16)},
    LAYOUT: {"keys": _key_names},
    PAD: {"axes": _positions(MAX_AXES, -1.0), "buttons": _positions(MAX_BUTTONS, 0.0)},
    STICKS: {
        "translation": numbers(3, 1),
        "rotation": numbers(2, 1),
        "fine": yes_or_no,
        "yawDeg": number(-360, 360, "degrees"),
    },
    ORBIT: {
        "aroundDeg": number(-180, 180, "degrees"),
        "higherDeg": number(-180, 180, "degrees"),
        "zoom": number(0.1, 10),
    },
    PRESS: {"control": text(40)},
    ITEM: {"name": text(80)},
    TEXT: {"name": text(80), "value": _maybe_empty(200)},
    PICTURE: {"task": _maybe_empty(80), "share": number(0, 1)},
    FRAMES: {"shown": _COUNT, "dropped": _COUNT, "refreshHz": _RATE},
    VISIBILITY: {"isVisible": yes_or_no},
    WORN: {"eyes": _pose_or_null, "left": _pose_or_null, "right": _pose_or_null},
    ALIVE: {},
}
"""Every message a view may send, and how each of its members is checked."""


def check_message(content: str) -> Received:
    """Return the message that a text holds."""
    values = decode_message_object(content, "A message")
    kind = values.pop("type", None)
    if not isinstance(kind, str) or kind not in MEMBERS:
        raise InputError(f"The type of a message must be one of {', '.join(MEMBERS)}.")
    members = MEMBERS[kind]
    if values.keys() != members.keys():
        names = ", ".join(members) or "no further member"
        raise InputError(f"The message {kind} must have {names}.")
    checked = (
        accepted(check, values[name], f"The message {kind}: {name}")
        for name, check in members.items()
    )
    return Received(kind, tuple(checked))
