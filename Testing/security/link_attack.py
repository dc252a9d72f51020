"""Many clients at once that send what they should not, to a simulator in its own process."""

from __future__ import annotations

import asyncio
import contextlib
import itertools

from Testing.security.mutated_messages import MutatedMessages
from Testing.security.wire_police import WirePolice

HOST = "127.0.0.1"
MESSAGES_A_CONNECTION = 200
PIECE = 8
PATIENCE_S = 120.0


class LinkAttack:
    """Sends mutated messages; every byte that comes back is checked for what harms Slicer.

    Attributes:
        sent: messages that were handed to open connections.
        connections: that were made.
        ended: of these, ended by the server before all was sent.
    """

    def __init__(self, port: int, count: int, seed: int, clients: int = 4, policed: int = 1):
        """Prepare to send `count` messages; the answers on every `policed`-th connection count."""
        self._port = port
        self._count = count
        self._seeds = itertools.count(seed)
        self._clients = clients
        self._policed = policed
        self.sent = self.connections = self.ended = 0
        self.seen: dict[bytes, int] = {}

    def run(self) -> None:
        """Attack, and return when the server has read or refused everything."""
        asyncio.run(self._run())

    async def _run(self) -> None:
        await asyncio.gather(*(self._attack() for _ in range(self._clients)))

    async def _attack(self) -> None:
        while self.sent < self._count:
            self.connections += 1
            is_policed = self.connections % self._policed == 0
            messages = MutatedMessages(next(self._seeds))
            reader, writer = await asyncio.open_connection(HOST, self._port)
            reading = asyncio.create_task(self._read(reader, is_policed))
            try:
                await asyncio.wait_for(self._send(messages, reading, writer), PATIENCE_S)
                # What is closed on both sides has been read to its end.
                await asyncio.wait_for(reading, PATIENCE_S)
            finally:
                reading.cancel()
                writer.close()
                with contextlib.suppress(ConnectionError):
                    await writer.wait_closed()

    async def _send(
        self, messages: MutatedMessages, reading: asyncio.Task, writer: asyncio.StreamWriter
    ) -> None:
        try:
            writer.write(messages.first())
            for number in range(MESSAGES_A_CONNECTION // PIECE):
                if reading.done():
                    self.ended += 1
                    return
                writer.write(b"".join(messages.next() for _ in range(PIECE)))
                self.sent += PIECE
                await writer.drain()
                if number % 8 == 0:
                    await asyncio.sleep(0)
            if next(self._seeds) % 4 == 0:
                writer.write(messages.fatal())
            writer.write_eof()
        except OSError:  # It was ended on the other side.
            self.ended += 1

    async def _read(self, reader: asyncio.StreamReader, is_policed: bool) -> None:
        police = WirePolice()
        with contextlib.suppress(ConnectionError):
            while piece := await reader.read(65_536):
                if is_policed:
                    police.feed(piece)
        for kind, times in police.seen.items():
            self.seen[kind] = self.seen.get(kind, 0) + times
