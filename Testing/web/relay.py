"""A piece of network between a browser and the simulator that can stall or break."""

from __future__ import annotations

import asyncio
import contextlib

from Testing.simulator.net.igtl.servers import LoopThread

HOST = "127.0.0.1"
CHUNK = 65536


class Relay:
    """Passes bytes on in both directions; ended by the `with` statement.

    Attributes:
        url: of this end.
    """

    def __init__(self, port: int):
        """Lead to a port of this computer."""
        self._target = port
        self._thread = LoopThread()
        self._writers: list[asyncio.StreamWriter] = []
        self._goes = asyncio.Event()
        self._goes.set()

    def __enter__(self) -> Relay:
        self._thread.__enter__()
        self._server = self._thread.run(asyncio.start_server(self._relay, HOST, 0))
        self.url = f"http://{HOST}:{self._server.sockets[0].getsockname()[1]}"
        return self

    def __exit__(self, *_exception: object) -> None:
        self._thread.call(self._server.close)
        self.cut()
        self._thread.__exit__()

    def stall(self) -> None:
        """Pass nothing on, like a wireless network out of reach, without an error."""
        self._thread.call(self._goes.clear)

    def resume(self) -> None:
        """Pass on the waiting bytes, and everything after them."""
        self._thread.call(self._goes.set)

    def cut(self) -> None:
        """Break all connections; clients can connect anew."""
        self._thread.call(self._close_all)

    def _close_all(self) -> None:
        for writer in self._writers:
            writer.transport.abort()
        self._writers.clear()

    async def _relay(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        far_reader, far_writer = await asyncio.open_connection(HOST, self._target)
        self._writers += [writer, far_writer]
        directions = (self._pass(reader, far_writer), self._pass(far_reader, writer))
        await asyncio.gather(*directions)

    async def _pass(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with contextlib.suppress(ConnectionError):
            while content := await reader.read(CHUNK):
                await self._goes.wait()
                writer.write(content)
                await writer.drain()
        writer.close()
