"""The screen: everything that the trainee reads and can choose now, for every view to draw."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from enum import Enum
from typing import Annotated, Any, Literal

from rastrainer.json_checks import number, numbers
from rastrainer_simulator.texts.texts import Texts
from rastrainer_simulator.vectors import RecordVector


def any_text(value: Any) -> str:
    """Accept text in any language, which may have spaces that count as not printable."""
    if not isinstance(value, str):
        raise ValueError("a text")
    return value


Words = Annotated[str, any_text]
ControlsPicture = Literal["", "gamepad", "keyboard", "controllers"]
Depth = Annotated[float, number(-5000.0, 5000.0, "mm")]
PRESS = "press "
"""Prefix of the name of a control: the item of a hint whose click presses that control."""


class Tone(str, Enum):
    """How a sentence or a figure is meant; a view gives each its color."""

    PLAIN = "plain"
    GOOD = "good"
    WARNING = "warning"
    ERROR = "error"


class ItemKind(str, Enum):
    """The kind of an item.

    A button is pressed, a choice goes left and right through its options, a text is typed, and an
    axis only shows a position from −1 to 1, as on the screen that tests the gamepad.
    """

    BUTTON = "button"
    CHOICE = "choice"
    TEXT = "text"
    AXIS = "axis"


@dataclasses.dataclass(frozen=True)
class MenuItem:
    """One line of a menu; a view sends its name back when it is clicked.

    The value is ready to be shown. While the item has the focus, its help is shown, such as why it
    cannot be chosen, and the picture at a path of the simulator's HTTP server.
    """

    name: Words
    label: Words
    kind: ItemKind = ItemKind.BUTTON
    value: Words = ""
    is_enabled: bool = True
    help: Words = ""
    picture: Words = ""


@dataclasses.dataclass(frozen=True)
class Fact:
    """One line of a table of results, its value with the unit."""

    label: Words
    value: Words
    tone: Tone = Tone.PLAIN


@dataclasses.dataclass(frozen=True)
class ScoreTrend:
    """A trainee's scores as a small plot of bars, oldest first; as text for who cannot see it.

    `mark` is the score that passes, drawn as a line; 0 for none.
    """

    text: Words
    scores: tuple[Annotated[float, number(0, 100)], ...]
    mark: Annotated[float, number(0, 100)] = 0.0


class SliceMark(str, Enum):
    """The meaning of a line in a slice; a view gives each its color and shape."""

    SKIN = "skin"
    POINT = "point"
    TRACE = "trace"
    RESIDUAL = "residual"
    TARGET = "target"
    REACHED = "reached"
    TIP = "tip"


@dataclasses.dataclass(frozen=True)
class SliceLine:
    """A line in a slice, or its single points: right and up from the slice's middle, mm."""

    mark: SliceMark
    points: tuple[Annotated[tuple[float, float], numbers(2, 5000.0, "mm")], ...]


@dataclasses.dataclass(frozen=True)
class Slice:
    """A slice of the images; `letters` name the patient's sides at its left, right, bottom, top."""

    name: Words
    letters: tuple[Words, ...]
    lines: tuple[SliceLine, ...]


@dataclasses.dataclass(frozen=True)
class SliceLegend:
    """The name of a mark."""

    mark: SliceMark
    name: Words


@dataclasses.dataclass(frozen=True)
class HeadSlices:
    """Slices of the images, all to one scale; as text for people who cannot see them."""

    text: Words
    slices: tuple[Slice, ...]
    legend: tuple[SliceLegend, ...]


@dataclasses.dataclass(frozen=True)
class Menu:
    """A panel over the picture; its name is never shown.

    `focus` is the name of an item, or "". The picture is of the controls, in which the inputs
    named by the facts are colored. `clock` is the time left, None without a limit.
    """

    name: Words
    title: Words
    paragraphs: tuple[Words, ...] = ()
    facts: tuple[Fact, ...] = ()
    items: tuple[MenuItem, ...] = ()
    focus: Words = ""
    picture: ControlsPicture = ""
    trend: ScoreTrend | None = None
    slices: HeadSlices | None = None
    clock: ScreenMessage | None = None


@dataclasses.dataclass(frozen=True)
class ScreenMessage:
    """A sentence to the trainee."""

    text: Words
    tone: Tone = Tone.PLAIN


@dataclasses.dataclass(frozen=True)
class ErrorArrow:
    """The error of one touch, or a line of a procedure, drawn in the scene in its tone's color.

    Attributes:
        begin, end: (x, y, z) in World, m, with a ball at the end; equal for the ball alone. Errors
            of touches are drawn longer than they are.
        tone: how large the error is, or which line it is.
        name: written above the ball, such as the name of a checkpoint; "" for nothing.
    """

    begin: RecordVector
    end: RecordVector
    tone: Tone
    name: Words = ""


@dataclasses.dataclass(frozen=True)
class DepthRuler:
    """A scale along the axis of the locked guide: planned distances from its tip.

    Attributes:
        outer_mm, inner_mm: of the tables of the skull; None if the line does not meet them.
        names: of the four in their order, written next to the scale.
    """

    entry_mm: Depth
    outer_mm: Annotated[float | None, number(-5000.0, 5000.0, "mm")]
    inner_mm: Annotated[float | None, number(-5000.0, 5000.0, "mm")]
    target_mm: Depth
    names: tuple[Words, ...]


@dataclasses.dataclass(frozen=True)
class Hint:
    """Which control does what at the moment, such as "A" and "Touch".

    `item` is what a view sends back when the hint is clicked, by a mouse alone; "" for nothing.
    """

    control: Words
    action: Words
    item: Words = ""


@dataclasses.dataclass(frozen=True)
class Screen:
    """Everything except the scene.

    Attributes:
        menu: None while the trainee works.
        warnings: each is shown as long as it lasts: contact, no gamepad, connection lost.
        status: short facts for the edge of the picture, such as "Task 2", "7 of 15", "03:21".
        language: BCP 47 tag of all texts.
        has_sticks: whether the view that has control draws two sticks, to be dragged by a mouse.
        sticks_navigate: whether a headset's sticks step as in a menu, though none is open: while
            a trial is shown again.
        has_arrow: whether a view shows an arrow toward a next point that is out of sight.
        is_head_clear: whether the skin is drawn clear, so that the inside of the head is seen.
        coverage: what the paint on the skin says while it is traced; "" where none is painted.
        is_private: whether what the menu offers is only for the views of who operates.
    """

    menu: Menu | None = None
    instruction: ScreenMessage = ScreenMessage("")
    warnings: tuple[ScreenMessage, ...] = ()
    status: tuple[Words, ...] = ()
    hints: tuple[Hint, ...] = ()
    language: Words = "en"
    is_spoken: bool = False
    has_sticks: bool = False
    sticks_navigate: bool = False
    has_arrow: bool = False
    errors: tuple[ErrorArrow, ...] = ()
    is_head_clear: bool = False
    coverage: Words = ""
    ruler: DepthRuler | None = None
    is_private: bool = False


def without_secrets(screen: Screen) -> Screen:
    """Return a private screen as others see it: the subject of its menu, and nothing to choose."""
    if screen.menu is None or not screen.is_private:
        return screen
    menu = dataclasses.replace(screen.menu, facts=(), items=(), focus="")
    return dataclasses.replace(screen, menu=menu)


NOTICE_S = 5.0


class Notices:
    """Sentences besides the instruction, shown for some seconds or until they are withdrawn."""

    def __init__(self) -> None:
        self._time = 0.0
        self._brief: list[tuple[float, ScreenMessage]] = []
        self._lasting: dict[str, tuple[str, Mapping[str, object]]] = {}

    def advance(self, dt: float) -> None:
        self._time += dt

    def add(self, text: str, tone: Tone = Tone.PLAIN, seconds: float = NOTICE_S) -> None:
        self._brief = [each for each in self._brief if each[1].text != text]
        self._brief.append((self._time + seconds, ScreenMessage(text, tone)))

    def warn(self, about: str, key: str = "", **values: object) -> None:
        """Show a warning until it is withdrawn by an empty key."""
        self._lasting.pop(about, None)
        if key:
            self._lasting[about] = key, values

    def shown(self, texts: Texts) -> tuple[ScreenMessage, ...]:
        self._brief = [each for each in self._brief if each[0] > self._time]
        said = (texts.say(key, **values) for key, values in self._lasting.values())
        lasting = (ScreenMessage(text, Tone.WARNING) for text in said)
        return (*lasting, *(message for _, message in self._brief))
