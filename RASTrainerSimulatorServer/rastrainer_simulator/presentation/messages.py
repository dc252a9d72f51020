"""Every message between the simulator and its views and boards, as one dataclass each.

`tools/page_types.py` writes the page's TypeScript types from them. docs/views.md explains the
messages. Their `type` on the wire is a class attribute.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Annotated, Any, ClassVar, Literal, cast

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    decode_message_object,
    number,
    numbers,
    object_of,
    text,
    texts,
    whole_number,
)
from rastrainer.json_records import record_fields, record_from_json
from rastrainer.protocol import Phase, Proximity
from rastrainer_simulator.ops.instructor_pin import LONGEST_PIN
from rastrainer_simulator.presentation.screen import Screen, Words
from rastrainer_simulator.state import TouchStage
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.texts.texts import NARROW_SPACE, NO_BREAK_SPACE
from rastrainer_simulator.trial_state import Tool
from rastrainer_simulator.vectors import RecordVector, Vector
from rastrainer_simulator.viewpoint.view_control import CameraPose

PROTOCOL = 1
SUBPROTOCOL = "rastrainer.views.1"
WATCHING_KINDS = ("spectator", "board")
"""The kinds of views that may only send that they are alive."""
MAX_LAYOUT_KEYS = 80
MAX_KEY_TEXT, MAX_ITEM_TEXT, MAX_DEVICE_TEXT = 16, 200, 80
MAX_FRAMES = 10_000
STICK_SLACK = 1.5
"""Gamepads go a little beyond ±1; a message with a larger value is refused."""
MAX_SEAT_WARNINGS = 8
NEARLY_UNIT = 0.01
"""How much the length of a rounded quaternion may differ from 1."""

Pose = tuple[float, float, float, float, float, float, float]
"""x, y, z (m) and the unit quaternion qx, qy, qz, qw, in World."""
_POSE = numbers(7, 100.0)


_NAMES = object_of(256)


def _headset_pose(value: Any) -> tuple[float, ...]:
    pose = _POSE(value)
    if abs(math.hypot(*pose[3:]) - 1.0) > NEARLY_UNIT:
        raise ValueError("a position (m) and a unit quaternion, or null")
    return pose


def _stick_positions(most: int, lowest: float) -> Any:
    check_one = number(-STICK_SLACK, STICK_SLACK)

    def check(value: Any) -> tuple[float, ...]:
        if not isinstance(value, list) or len(value) > most:
            raise ValueError(f"a list of at most {most} numbers")
        return tuple(min(1.0, max(lowest, check_one(item))) for item in value)

    return check


Count = Annotated[int, whole_number(0, 2**53)]
FrameCount = Annotated[int, whole_number(0, MAX_FRAMES)]
RefreshHz = Annotated[float, number(0, 1000, "Hz")]
Time = Annotated[float, number(0, 1e9, "s")]
Length = Annotated[float, number(-1e6, 1e6, "mm")]
Share = Annotated[float, number(0, 1)]
Unit3 = Annotated[Vector, numbers(3, 1)]
Millimeters2 = Annotated[tuple[float, float], numbers(2, 1e6, "mm")]
HeadsetPart = Annotated[Pose | None, _headset_pose]


class ViewMessage:
    """One message; `type` is that on the wire."""

    type: ClassVar[str]


@dataclass(frozen=True)
class HeadsetPose:
    """Where a worn headset's eyes and its controllers are; None without one.

    The eyes' middle looks along −z with y up, and the controllers point along −z.
    """

    eyes: HeadsetPart
    left: HeadsetPart
    right: HeadsetPart


# Sent by the simulator.


@dataclass(frozen=True)
class News(ViewMessage):
    """The messages to a view; a board receives a `WelcomeNews` and `SeatNews`."""


@dataclass(frozen=True)
class WelcomeNews(News):
    """The first message: the number of the view, and the bodies in the order of a state's poses."""

    type = "welcome"
    protocol: Count
    view: Count
    bodies: tuple[Words, ...]


@dataclass(frozen=True)
class SceneNews(News):
    """The scene's file, and what goes with it: fiducials by label in the head's frame, m.

    `no_go` has the nodes of the no-go structures of each procedure.
    """

    type = "scene"
    url: Words
    task: Words
    sticks: AxesChoice
    cameras: Annotated[Mapping[str, CameraPose], _NAMES]
    fiducials: Annotated[Mapping[str, Annotated[Vector, numbers(3, 5000.0)]], _NAMES]
    no_go: Annotated[Mapping[str, Annotated[tuple[str, ...], texts(0, 256)]], _NAMES]


@dataclass(frozen=True)
class GuideAim:
    """Offset of the planned line from the guide's axis, seen along the axis: right and up."""

    entry_mm: Millimeters2
    target_mm: Millimeters2
    entry_distance_mm: Length
    angle_deg: Annotated[float, number(-360, 360, "degrees")]


@dataclass(frozen=True)
class ProcedureNews:
    """State of the tool in a procedure: how far it is fed beyond the guide's tip.

    `aim` is None unless a guide is being aligned.
    """

    name: Words
    tool: Tool
    feed_mm: Length
    aim: GuideAim | None


@dataclass(frozen=True)
class CoveringBodies:
    """Bodies of the arm that cover tip or next point, which views draw translucent."""

    view: tuple[Words, ...] = ()
    inset: tuple[Words, ...] = ()
    headset: tuple[Words, ...] = ()


@dataclass(frozen=True)
class StateNews(News):
    """State of the simulation, sent 60 times a second.

    Attributes:
        poses: of `WelcomeNews.bodies`.
        ghost: poses by body of an earlier trial that is shown next to the arm; None without one.
        inset: camera along the skin or across the line of a procedure; None without either.
        planned_target: World, m.
        delayed: late and skipped ticks of the control loop.
        headset: for spectators only; None while nobody wears a headset.
    """

    type = "state"
    tick: Count
    time_s: Time
    poses: tuple[Annotated[Pose, _POSE], ...]
    ghost: Annotated[Mapping[str, Annotated[Pose, _POSE]] | None, _NAMES]
    clearance_mm: Length
    proximity: Proximity
    touch: TouchStage
    camera: Words
    view: CameraPose
    inset: CameraPose | None
    translucent: CoveringBodies
    phase: Phase
    next: Annotated[str | None, text()]
    touched: tuple[Words, ...]
    elapsed_s: Time
    planned_target: Annotated[Vector | None, numbers(3, 5000.0)]
    delayed: Count
    procedure: ProcedureNews | None
    headset: HeadsetPose | None = None


@dataclass(frozen=True)
class ScreenNews(News):
    """A new screen: everything that the trainee reads."""

    type = "screen"
    screen: Screen


@dataclass(frozen=True)
class Feedback(News):
    """A sound and a vibration of a `FeedbackEvent`, to be played once.

    The numbers count from 1 without a gap. The volume is 0 while sounds are muted.
    """

    type = "event"
    number: Count
    kind: Words
    sound: Words = ""
    volume: Share = 1.0
    rumble: Share = 0.0
    rumble_ms: Count = 0


@dataclass(frozen=True)
class ControlNews(News):
    """The holder of control, "" for nobody; `is_you` is true for the view that holds it."""

    type = "control"
    holder: Words
    is_you: bool


@dataclass(frozen=True)
class PairingNews(News):
    """How another view is paired; only for views on the simulator's own computer."""

    type = "pairing"
    code: Words
    addresses: tuple[Words, ...]


@dataclass(frozen=True)
class SkinPlace:
    """A point on the skin in the head's frame (RAS), and the outward unit normal there."""

    position_mm: RecordVector
    normal: RecordVector


@dataclass(frozen=True)
class TraceNews(News):
    """New points of a trace over the skin, in the head's frame; `known` earlier points remain.

    Within `covered_mm` around the points the skin is painted; 0 for no paint.
    """

    type = "trace"
    known: Count
    points: tuple[RecordVector, ...]
    covered_mm: Length
    next: SkinPlace | None


_SPACES = str.maketrans({NARROW_SPACE: " ", NO_BREAK_SPACE: " "})
"""French and Chinese texts have spaces that count as not printable."""


def _seat_words(longest: int) -> Any:
    """Accept printable text of a simulator in any language."""
    check = text(longest, min_length=0)

    def checked(value: Any) -> str:
        check(value.translate(_SPACES) if isinstance(value, str) else value)
        return str(value)

    return checked


def _first_warnings(value: Any) -> Any:
    """Accept a list, of which a tile shows the first few."""
    return value[:MAX_SEAT_WARNINGS] if isinstance(value, list) else value


SeatName = Annotated[str, _seat_words(200)]
SeatSentence = Annotated[str, _seat_words(600)]
Points = Annotated[int, whole_number(0, 1000)]


@dataclass(frozen=True)
class Seat:
    """State of a seat on a teacher's board, except for its trial.

    `count` is of the points of the open trial's task, `screen` the title of the open menu, and
    `assignments` a sentence about the trainee's curriculum; each is empty without one.
    """

    trainee: SeatName = ""
    task: SeatName = ""
    count: Points = 0
    screen: SeatName = ""
    instruction: SeatSentence = ""
    warnings: Annotated[tuple[SeatSentence, ...], _first_warnings] = ()
    score: Annotated[float | None, number(0, 100)] = None
    holder: SeatName = ""
    slicer: bool = False
    language: Annotated[str, text(12)] = "en"
    assignments: SeatSentence = ""


@dataclass(frozen=True, kw_only=True)
class SeatReport(Seat):
    """State of a seat and its trial. `rejected` counts refused touches."""

    phase: Phase
    touched: Points
    rejected: Annotated[int, whole_number(0, 1_000_000)]
    elapsed_s: Annotated[int, whole_number(0, 10_000_000)]
    touch: TouchStage


@dataclass(frozen=True, kw_only=True)
class SeatNews(SeatReport, ViewMessage):
    """A change of a seat, for boards."""

    type = "seat"


# Sent by a view.


@dataclass(frozen=True)
class ViewInput(ViewMessage):
    """The messages from a view."""


@dataclass(frozen=True)
class Hello(ViewInput):
    """A view's description of itself when it joins."""

    type = "hello"
    kind: Literal["desktop", "page", "headset", "spectator", "board"]
    device: Annotated[str, text(MAX_DEVICE_TEXT, 0)] = ""
    refresh_hz: RefreshHz = 0.0


@dataclass(frozen=True)
class KeyInput(ViewInput):
    """A key went down or up: its W3C `KeyboardEvent.code`, and the text that it types."""

    type = "key"
    code: Annotated[str, text(32)]
    is_down: bool
    text: Annotated[str, text(MAX_KEY_TEXT, 0)]


@dataclass(frozen=True)
class LayoutInput(ViewInput):
    """Labels of the keys by their codes, such as "q" on KeyA in France."""

    type = "layout"
    keys: Annotated[Mapping[str, Annotated[str, text(8)]], object_of(MAX_LAYOUT_KEYS, text(32))]


@dataclass(frozen=True)
class PadInput(ViewInput):
    """A gamepad that the browser reads: axes −1 to 1 and buttons 0 to 1 of the W3C gamepad."""

    type = "pad"
    axes: Annotated[tuple[float, ...], _stick_positions(16, -1.0)]
    buttons: Annotated[tuple[float, ...], _stick_positions(32, 0.0)]


@dataclass(frozen=True)
class SticksInput(ViewInput):
    """Sticks of XR controllers or on the screen, as in `OperatorInput`.

    Forward is where the eyes look: `yaw_deg`, counterclockwise from World's x.
    """

    type = "sticks"
    translation: Unit3
    rotation: Annotated[tuple[float, float], numbers(2, 1)]
    fine: bool
    yaw_deg: Annotated[float, number(-360, 360, "degrees")]


@dataclass(frozen=True)
class OrbitInput(ViewInput):
    """A turn of the view: around to the right, higher, and its distance multiplied."""

    type = "orbit"
    around_deg: Annotated[float, number(-180, 180, "degrees")]
    higher_deg: Annotated[float, number(-180, 180, "degrees")]
    zoom: Annotated[float, number(0.1, 10)]


@dataclass(frozen=True)
class PressInput(ViewInput):
    """One press of a control, by its name in the settings of the controls."""

    type = "press"
    control: Annotated[str, text(40)]


@dataclass(frozen=True)
class ItemInput(ViewInput):
    """A click on an item of the menu or of a hint."""

    type = "item"
    name: Annotated[str, text(80)]


@dataclass(frozen=True)
class TextInput(ViewInput):
    """The new text of a text item."""

    type = "text"
    name: Annotated[str, text(80)]
    value: Annotated[str, text(MAX_ITEM_TEXT, 0)]


@dataclass(frozen=True)
class PictureProgress(ViewInput):
    """How much of a task's scene a view has loaded; 1 once it is drawn."""

    type = "picture"
    task: Annotated[str, text(80, 0)]
    share: Share


@dataclass(frozen=True)
class Frames(ViewInput):
    """How smoothly a view has drawn during the last second."""

    type = "frames"
    shown: FrameCount
    dropped: FrameCount
    refresh_hz: RefreshHz


@dataclass(frozen=True)
class Visibility(ViewInput):
    """Whether the trainee sees the view: the headset was doffed, the page hidden."""

    type = "visibility"
    is_visible: bool


@dataclass(frozen=True)
class HeadsetInput(HeadsetPose, ViewInput):
    """Where a headset and its controllers are, at most 30 times a second."""

    type = "headsetPose"


@dataclass(frozen=True)
class Alive(ViewInput):
    """A sign of life: everything held is still held."""

    type = "alive"


INPUTS: Mapping[str, type[ViewInput]] = {each.type: each for each in ViewInput.__subclasses__()}


class ViewRole(str, Enum):
    """The role for which a client was paired."""

    VIEW = "view"
    """May see and drive."""
    SPECTATOR = "spectator"
    """May see everything and drive nothing."""
    BOARD = "board"
    """A teacher's board: a spectator whose key outlives the simulator's process."""


@dataclass(frozen=True)
class PairingRequest:
    """`POST /pair`: the code that the simulator shows."""

    code: Annotated[str, text()]
    role: ViewRole = ViewRole.VIEW


class InstructorOrder(str, Enum):
    """Orders that a teacher can give to a seat."""

    PAUSE = "pause"
    SAY = "say"
    """Show the trainee a sentence."""
    REPLAY = "replay"
    """Show the scored trial again, at the seat."""


@dataclass(frozen=True)
class OrderRequest:
    """`POST /instructor`: an order of a board, with the seat's PIN and the sentence to say."""

    pin: Annotated[str, text(LONGEST_PIN)]
    order: InstructorOrder
    text: Annotated[str, text(200, 0)] = ""

    def __post_init__(self) -> None:
        if self.order is InstructorOrder.SAY and not self.sentence:
            raise InputError("The text must say something.")

    @property
    def sentence(self) -> str:
        return self.text.strip() if self.order is InstructorOrder.SAY else ""


def message_text(message: ViewMessage) -> str:
    """Return a message as it is sent, with all its members."""
    values = {"type": message.type, **_members(message)}
    return json.dumps(
        values, default=_members, ensure_ascii=False, allow_nan=False, separators=(",", ":")
    )


def _members(record: Any) -> dict[str, Any]:
    """Return the members of a record, faster than `record_to_json`: nested records stay records."""
    fields = record_fields(cast("Any", type(record)))
    return {each.key: getattr(record, each.name) for each in fields}


def read_view_input(content: str) -> ViewInput:
    """Return the message of a view that a text holds."""
    values = decode_message_object(content, "A message")
    kind = values.pop("type", None)
    if not isinstance(kind, str) or kind not in INPUTS:
        raise InputError(f"The type of a message must be one of {', '.join(INPUTS)}.")
    return record_from_json(INPUTS[kind], values, f"The message {kind}", only_known=True)
