"""One watched simulator: the state of its seat."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

import aiohttp

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_message_object
from rastrainer.json_records import record_from_json
from rastrainer_simulator.board.board_messages import SeatLink, TileNews
from rastrainer_simulator.board.seats import (
    OtherCertificateError,
    SeatClient,
    SeatEntry,
    UnpairedError,
)
from rastrainer_simulator.presentation.messages import Hello, SeatNews, message_text

RETRY_S = 2.0
_BOARD_HELLO = message_text(Hello("board"))


class WatchedSeat:
    """Watches one simulator in a separate task."""

    def __init__(self, entry: SeatEntry, client: SeatClient, changed: Callable[[], None]) -> None:
        """Start to watch; `changed` is called whenever the tile changes."""
        self.entry = entry
        self._client = client
        self._changed = changed
        self._link = SeatLink.CONNECTING
        self._seat: SeatNews | None = None
        self._task = asyncio.create_task(self._watch())

    def tile(self) -> TileNews:
        entry = self.entry
        return TileNews(entry.id, entry.name, entry.address, self._link, self._seat)

    async def close(self) -> None:
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)

    async def _watch(self) -> None:
        while True:
            link = SeatLink.AWAY
            try:
                await self._receive()
            except UnpairedError:
                link = SeatLink.UNPAIRED
            except OtherCertificateError:
                link = SeatLink.OTHER_CERTIFICATE
            except (InputError, aiohttp.ClientError, OSError):
                pass
            self._become(link)
            await asyncio.sleep(RETRY_S)

    async def _receive(self) -> None:
        """Receive what the simulator sends until the connection ends."""
        stream = await self._client.stream(self.entry)
        try:
            await stream.send_str(_BOARD_HELLO)
            async for message in stream:
                if message.type is not aiohttp.WSMsgType.TEXT:
                    return
                values = decode_message_object(message.data, "The message of a simulator")
                if values.get("type") == SeatNews.type:
                    seat = record_from_json(SeatNews, values, "The seat")
                    self._become(SeatLink.WATCHING, seat)
        finally:
            await stream.close()

    def _become(self, link: SeatLink, seat: SeatNews | None = None) -> None:
        if (link, seat) != (self._link, self._seat):
            self._link, self._seat = link, seat
            self._changed()
