"""Many clients at once that send invalid messages, to a simulator in its own process."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import itertools
from collections import Counter

from rastrainer.igtl.message import CONTENTS, MessageReader, StreamError
from rastrainer_simulator.net.igtl.server import MESSAGE_BYTES
from Testing.security.mutated_messages import MutatedMessages
from Testing.security.wire_checker import WireChecker

HOST = "127.0.0.1"
MESSAGES_A_CONNECTION = 200
PIECE = 8
CONNECTIONS_PER_COLLECTION = 20
SWALLOWED = 3
"""If so many messages in a row complete nothing, they count as an earlier message's body."""
TIMEOUT_S = 120.0


class LinkAttack:
    """Sends mutated messages; every byte that comes back is checked for what harms Slicer.

    A message that claims to be long swallows later messages: then the attack continues with
    another connection, so that the server reads nearly all messages.

    `mutated` counts the invalid messages among all `sent`. A reader like the server's takes
    `decoded` messages from the same bytes; `refused` counts the rest by kind of error.
    """

    def __init__(self, port: int, count: int, seed: int, clients: int = 4, policed: int = 1):
        """Prepare `count` mutated messages; check the answers on each `policed`-th connection."""
        self._port = port
        self._count = count
        self._seeds = itertools.count(seed)
        self._clients = clients
        self._check_every = policed
        self.sent = self.mutated = self.decoded = self.connections = 0
        self.refused: Counter[StreamError] = Counter()
        self.seen: Counter[bytes] = Counter()

    def run(self) -> None:
        """Attack, and return when the server has read or refused everything."""
        asyncio.run(self._run())

    async def _run(self) -> None:
        await asyncio.gather(*(self._attack() for _ in range(self._clients)))

    async def _attack(self) -> None:
        while self.mutated < self._count:
            self.connections += 1
            is_policed = self.connections % self._check_every == 0
            messages = _Messages(next(self._seeds))
            reader, writer = await asyncio.open_connection(HOST, self._port)
            reading = asyncio.create_task(self._read(reader, is_policed))
            try:
                await asyncio.wait_for(self._send(messages, reading, writer), TIMEOUT_S)
                # A connection closed on both sides has been read to its end.
                await asyncio.wait_for(reading, TIMEOUT_S)
            finally:
                reading.cancel()
                writer.close()
                with contextlib.suppress(ConnectionError):
                    await writer.wait_closed()
            self.sent += messages.sent
            self.mutated += messages.mutations.mutated
            self.decoded += messages.decoded
            self.refused += messages.reader.errors
            if self.connections % CONNECTIONS_PER_COLLECTION == 0:
                # Python collects no garbage within a test, and streams are cycles.
                gc.collect(1)

    async def _send(
        self, messages: _Messages, reading: asyncio.Task, writer: asyncio.StreamWriter
    ) -> None:
        with contextlib.suppress(OSError):  # The other side has ended it.
            writer.write(messages.fed(messages.mutations.first()))
            for number in range(MESSAGES_A_CONNECTION // PIECE):
                if reading.done():
                    return
                writer.write(messages.next_piece())
                await writer.drain()
                if messages.are_swallowed:
                    break
                if number % 8 == 0:
                    await asyncio.sleep(0)
            if next(self._seeds) % 4 == 0:
                writer.write(messages.fed(messages.mutations.fatal()))
            writer.write_eof()

    async def _read(self, reader: asyncio.StreamReader, is_policed: bool) -> None:
        police = WireChecker()
        with contextlib.suppress(ConnectionError):
            while piece := await reader.read(65_536):
                if is_policed:
                    police.feed(piece)
        self.seen += police.seen


class _Messages:
    """One connection's messages, also decoded by a reader like the server's."""

    def __init__(self, seed: int) -> None:
        self.mutations = MutatedMessages(seed)
        self.reader = MessageReader(dict.fromkeys(CONTENTS, MESSAGE_BYTES))
        self._swallowed = 0
        self.sent = self.decoded = 0

    @property
    def are_swallowed(self) -> bool:
        """Whether the server seems to wait for the rest of an earlier message."""
        return self._swallowed >= SWALLOWED

    def next_piece(self) -> bytes:
        piece = bytearray()
        for _ in range(PIECE):
            self.sent += 1
            piece += self.fed(self.mutations.next())
            if self.are_swallowed:
                break
        return bytes(piece)

    def fed(self, data: bytes) -> bytes:
        before = self.reader.taken
        self.decoded += len(self.reader.feed(data))
        self._swallowed = 0 if self.reader.taken > before else self._swallowed + 1
        return data
