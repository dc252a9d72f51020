"""What belongs to a connection goes with it."""

import asyncio
import gc

import aiohttp
from aiohttp import web

from rastrainer_simulator.net.views.limited_server import Connections
from Testing.simulator.net.igtl.servers import HOST

LONG_S = 1000.0


def in_memory() -> int:
    """Return how many connections are still referenced."""
    gc.collect()
    return sum(isinstance(each, web.RequestHandler) for each in gc.get_objects())


def test_an_ended_connection_is_released_from_memory():
    connections = Connections(8, LONG_S)
    before = in_memory()

    async def answer(request: web.BaseRequest) -> web.Response:
        connections.note(request)
        return web.Response()

    async def ask_and_leave(url: str, is_last: bool) -> None:
        async with aiohttp.ClientSession() as session, session.get(url) as response:
            assert response.status == 200
            # Counting takes long: once is enough, after others have come and gone.
            assert not is_last or in_memory() == before + 1

    async def run() -> None:
        connections.server = web.Server(answer)
        server = await asyncio.get_running_loop().create_server(connections, HOST, 0)
        for is_last in (False, False, True):
            await ask_and_leave(f"http://{HOST}:{server.sockets[0].getsockname()[1]}", is_last)
            while connections.server.connections:
                await asyncio.sleep(0.01)
        server.close()

    asyncio.run(asyncio.wait_for(run(), 60.0))
