"""A network that stalls or breaks during training: paused, resumed, nothing lost."""

from __future__ import annotations

import asyncio
import contextlib

import pytest

from Testing.end_to_end.hands import Controllers, PageKeys
from Testing.end_to_end.lab import WITHOUT_GRAPHICS, Place
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.web.chromium import enter_headset, open_page, wait_for

LOST = "#warnings li[data-tone=error]:has-text('connection to the simulator was lost')"
TOUCHED = 2


HOST = "127.0.0.1"
CHUNK = 65536


class Relay:
    """A piece of network at `url` that leads to a port of this computer, and can stall or break."""

    def __init__(self, port: int):
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


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("network"), limits=WITHOUT_GRAPHICS) as place:
        yield place


@pytest.fixture
def relay(place):
    with Relay(int(place.url.rpartition(":")[2])) as relay:
        yield relay


@pytest.mark.soak
@pytest.mark.parametrize(
    ("fault", "headset"), [("cut", ""), ("stall", ""), ("stall", "metaQuest2")]
)
def test_a_cut_or_stalled_network_stops_the_arm_and_pauses_a_trial_that_then_goes_on(
    place, relay, browser, fault, headset
):
    page = open_page(browser, relay.url, place.code, headset, draws=False)
    if headset:
        enter_headset(page)
    trainee = place.carried_trainee((Controllers if headset else PageKeys)(page))
    trainee.begin("task-1", page)
    trainee.touch_all(TOUCHED)
    trainee.hands.push(0.0, 0.0, 1.0, False)
    getattr(relay, fault)()
    trainee.until(lambda: place.view.state["phase"] == "paused", "the pause")
    trainee.until_still()
    if headset:
        wait_for(page, "page.headset.panels.warning.root.textContent.includes('was lost')")
    elif fault == "stall":
        page.wait_for_selector(LOST)
    relay.resume()
    trainee.hands.push(0.0, 0.0, 0.0, False)
    trainee.resume()
    assert trainee.touched == TOUCHED
    trainee.touch_all(TOUCHED + 1)
    trainee.go_home()
    page.context.close()
