"""One watched simulator: stays joined, and keeps what the simulator says of its seat."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any

import aiohttp

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    accepted,
    decode_message_object,
    number,
    one_of,
    text,
    whole_number,
    yes_or_no,
)
from rastrainer.protocol import Phase
from rastrainer_simulator.board.seat_client import (
    OtherCertificateError,
    SeatClient,
    UnpairedError,
)
from rastrainer_simulator.board.seat_list import SeatEntry
from rastrainer_simulator.net.views.messages import BOARD, HELLO
from rastrainer_simulator.net.views.outgoing import SEAT
from rastrainer_simulator.ops.texts.typesetting import NARROW_SPACE, NO_BREAK_SPACE
from rastrainer_simulator.state import TouchStage

RETRY_S = 2.0
MOST_WARNINGS = 8
_HELLO = json.dumps({"type": HELLO, "kind": BOARD, "device": "", "refreshHz": 0})
_SPACES = str.maketrans({NARROW_SPACE: " ", NO_BREAK_SPACE: " "})
"""French and Chinese texts have spaces that count as not printable."""


def _words(longest: int) -> Callable[[Any], str]:
    """Accept words of a simulator in any language."""
    check = text(longest, min_length=0)

    def checked(value: Any) -> str:
        check(value.translate(_SPACES) if isinstance(value, str) else value)
        return str(value)

    return checked


_sentence, _short = _words(600), _words(200)


def _sentences(value: Any) -> list[str]:
    """Accept a few sentences."""
    if not isinstance(value, list):
        raise ValueError("a list of sentences")
    return [_sentence(each) for each in value[:MOST_WARNINGS]]


def _score(value: Any) -> float | None:
    """Accept 0 to 100, or null."""
    return None if value is None else number(0, 100)(value)


MEMBERS: Mapping[str, Callable[[Any], Any]] = {
    "trainee": _short,
    "task": _short,
    "count": whole_number(0, 1000),
    "screen": _short,
    "instruction": _sentence,
    "warnings": _sentences,
    "score": _score,
    "holder": _short,
    "slicer": yes_or_no,
    "language": text(12),
    "assignments": _sentence,
    "phase": one_of(*(phase.value for phase in Phase)),
    "touched": whole_number(0, 1000),
    "rejected": whole_number(0, 1_000_000),
    "elapsed": whole_number(0, 10_000_000),
    "touch": one_of(*(stage.value for stage in TouchStage)),
}
"""What a simulator says of its seat, and how each member is checked."""
_OF_LATER_SIMULATORS = {"assignments": ""}
"""What an earlier one does not say, and what that means."""


class SeatLink(str, Enum):
    """How the connection to a seat is."""

    CONNECTING = "connecting"
    WATCHING = "watching"
    AWAY = "away"
    UNPAIRED = "unpaired"
    OTHER_CERTIFICATE = "other certificate"


class WatchedSeat:
    """Watches one simulator in a task of its own.

    Attributes:
        entry: which one.
    """

    def __init__(self, entry: SeatEntry, client: SeatClient, changed: Callable[[], None]) -> None:
        """Begin to watch; `changed` is called whenever the tile is another."""
        self.entry = entry
        self._client = client
        self._changed = changed
        self._link = SeatLink.CONNECTING
        self._seat: dict[str, Any] | None = None
        self._task = asyncio.create_task(self._watch())

    def tile(self) -> dict[str, Any]:
        """Return what a board shows of it, ready for JSON; `seat` is None while it is away."""
        entry = self.entry
        return {
            "id": entry.id,
            "name": entry.name,
            "address": entry.address,
            "link": self._link.value,
            "seat": self._seat,
        }

    async def close(self) -> None:
        """Watch no longer."""
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)

    async def _watch(self) -> None:
        while True:
            try:
                await self._watch_once()
                self._become(SeatLink.AWAY)
            except UnpairedError:
                self._become(SeatLink.UNPAIRED)
            except OtherCertificateError:
                self._become(SeatLink.OTHER_CERTIFICATE)
            except (InputError, aiohttp.ClientError, OSError):
                self._become(SeatLink.AWAY)
            await asyncio.sleep(RETRY_S)

    async def _watch_once(self) -> None:
        """Take what the simulator says until the connection ends.

        Raises:
            InputError: it cannot be watched, or says something else than simulators do.
        """
        stream = await self._client.stream(self.entry)
        try:
            await stream.send_str(_HELLO)
            async for message in stream:
                if message.type is not aiohttp.WSMsgType.TEXT:
                    return
                values = decode_message_object(message.data, "The message of a simulator")
                if values.get("type") == SEAT:
                    self._become(SeatLink.WATCHING, checked_seat(values))
        finally:
            await stream.close()

    def _become(self, link: SeatLink, seat: dict[str, Any] | None = None) -> None:
        if (link, seat) != (self._link, self._seat):
            self._link, self._seat = link, seat
            self._changed()


def checked_seat(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a simulator says of its seat; what a newer one adds is left out.

    Raises:
        InputError: something is missing or cannot be.
    """
    values = {**_OF_LATER_SIMULATORS, **values}
    missing = MEMBERS.keys() - values.keys()
    if missing:
        raise InputError(f"What a simulator says of its seat lacks {', '.join(sorted(missing))}.")
    return {
        name: accepted(check, values[name], f"The seat's {name}") for name, check in MEMBERS.items()
    }
