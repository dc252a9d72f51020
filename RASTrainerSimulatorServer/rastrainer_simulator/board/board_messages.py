"""Every message between a board and its page, as one dataclass each; as `messages.py` for views."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Annotated

from rastrainer.json_checks import number, text
from rastrainer.protocol import AssignmentState
from rastrainer_simulator.presentation.messages import (
    Count,
    InstructorOrder,
    SeatReport,
    ViewMessage,
)
from rastrainer_simulator.presentation.screen import Words

BOARD_SUBPROTOCOL = "rastrainer.board.1"


class SeatLink(str, Enum):
    """State of the connection to a seat."""

    CONNECTING = "connecting"
    WATCHING = "watching"
    AWAY = "away"
    UNPAIRED = "unpaired"
    OTHER_CERTIFICATE = "other certificate"


@dataclass(frozen=True)
class TileNews:
    """A seat on the board; `seat` is None while it is not watched."""

    id: Words
    name: Words
    address: Words
    link: SeatLink
    seat: SeatReport | None


@dataclass(frozen=True)
class TilesNews(ViewMessage):
    """The seats of a board, at most four times a second."""

    type = "tiles"
    seats: tuple[TileNews, ...]


@dataclass(frozen=True)
class AssignmentColumn:
    """An assignment in the table of a class, in the page's language."""

    name: Words
    label: Words
    goal: Words


@dataclass(frozen=True)
class AssignmentCell:
    """A trainee's standing in an assignment; `reached_utc` is "" until it is reached."""

    state: AssignmentState
    progress: Words
    done: Annotated[float, number(0, 1e6)]
    needed: Count
    reached_utc: Words


@dataclass(frozen=True)
class TraineeRow:
    """A trainee in the table of a class; `next` is "" once all assignments are reached."""

    trainee: Words
    reached: Count
    next: Words
    cells: tuple[AssignmentCell, ...]


@dataclass(frozen=True)
class CurriculumTable:
    """Where the trainees of one curriculum stand."""

    title: Words
    assignments: tuple[AssignmentColumn, ...]
    trainees: tuple[TraineeRow, ...]


@dataclass(frozen=True)
class ClassNews:
    """Answer to `GET /class`.

    Attributes:
        has_study: whether the board reads a study; all else is empty without one.
        problem: why the study cannot be read now, "" if it can.
        as_of: when it was last read, ISO 8601; "" before the first time.
        without: pseudonyms of the active trainees who follow no curriculum.
    """

    has_study: bool
    problem: Words
    as_of: Words
    curricula: tuple[CurriculumTable, ...]
    without: tuple[Words, ...]


@dataclass(frozen=True)
class NewSeat:
    """`POST /seats`: a simulator to watch, with its pairing code.

    Without the `fingerprint` of an https address, the answer has it, to be compared.
    """

    name: Annotated[str, text(40)]
    address: Annotated[str, text(300)]
    code: Annotated[str, text(12, 0)] = ""
    fingerprint: Annotated[str, text(200, 0)] = ""


@dataclass(frozen=True)
class SeatOrder:
    """`POST /seat/ID/order`: an order to a seat; the board remembers the PIN."""

    order: InstructorOrder
    text: Annotated[str, text(200, 0)] = ""
    pin: Annotated[str, text(64, 0)] = ""
