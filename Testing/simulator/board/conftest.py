"""A board in its own event loop, and simulators that it watches by TLS."""

from __future__ import annotations

import json

import aiohttp
import pytest

from rastrainer_simulator.board.board_messages import BOARD_SUBPROTOCOL
from rastrainer_simulator.board.board_server import BoardServer
from rastrainer_simulator.board.seats import SeatClient
from rastrainer_simulator.net.views.certificate import own_certificate
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from Testing.free_port import free_port
from Testing.simulator.net.igtl.servers import HOST
from Testing.simulator.net.views.conftest import control_loop, own_cache, serve  # noqa: F401
from Testing.simulator.net.views.served import ServedViews, answered

PIN = "314159"


class WatchedSimulator:
    """A view server of the local network.

    Attributes:
        served: the server, with its presenter's calls.
        address: by TLS.
        fingerprint: of its certificate.
        config: its folder of settings.
        port: of the address.
    """

    def __init__(self, served: ServedViews, config, certificates, port: int = 0):
        self.served = served
        self.config = config
        certificate = own_certificate(certificates)
        listening = served.server.listen_in_network(port or free_port(), certificate.tls)
        self.port = served.thread.run(listening)
        self.fingerprint = certificate.fingerprint
        self.address = f"https://{HOST}:{self.port}"


class BoardClient:
    """A board, and a teacher's browser that is paired with it."""

    def __init__(self, thread, config, study=None):
        self.thread, self.config = thread, config
        self.client = thread.call(SeatClient)
        self._is_closed = False
        self.codes = []
        self.server = thread.call(BoardServer, config, self.client, self.codes.append, study=study)
        self.url = f"http://{HOST}:{thread.run(self.server.listen(HOST, 0))}"
        self.key = self.paired()

    def paired(self, role: str = "view") -> str:
        body = json.dumps({"code": self.server.code.code, "role": role})
        asking = answered(self.url, "/pair", "POST", data=body)
        status, _headers, answer = self.thread.run(asking)
        assert status == 200
        return json.loads(answer)["key"]

    def ask(self, path: str, method: str = "GET", key: str | None = None, **values):
        """Return the status, and the answer: decoded, or the sentence of a refusal."""
        headers = {"Authorization": f"Bearer {self.key if key is None else key}"}
        data = json.dumps(values) if method == "POST" else None
        asking = answered(self.url, path, method, headers=headers, data=data)
        status, _headers, answer = self.thread.run(asking)
        return status, json.loads(answer) if status == 200 else answer.decode()

    def add(self, simulator, name: str = "Window 3", **changes) -> str:
        """Pair the board with a simulator; return the seat's ID."""
        values = {
            "name": name,
            "address": simulator.address,
            "fingerprint": simulator.fingerprint,
            "code": simulator.served.code,
        }
        status, answer = self.ask("/seats", "POST", **{**values, **changes})
        assert status == 200, answer
        return answer["id"]

    def tiles_until(self, is_wanted, key: str | None = None) -> list[dict]:
        """Return the first tiles for which `is_wanted` is true."""

        async def read():
            headers = {"Authorization": f"Bearer {key or self.key}"}
            async with (
                aiohttp.ClientSession() as session,
                session.ws_connect(
                    f"{self.url}/tiles", protocols=[BOARD_SUBPROTOCOL], headers=headers
                ) as socket,
            ):
                while True:
                    tiles = (await socket.receive_json())["seats"]
                    if is_wanted(tiles):
                        return tiles

        return self.thread.run(read())

    def close(self):
        """End it; a second time does nothing."""
        if not self._is_closed:
            self._is_closed = True
            self.thread.run(self.server.close())
            self.thread.run(self.client.__aexit__(None, None, None))


@pytest.fixture(scope="session")
def certificates(tmp_path_factory):
    return tmp_path_factory.mktemp("certificates")


@pytest.fixture
def simulator(serve, tmp_path, certificates):  # noqa: F811
    config = tmp_path / "seat"
    config.mkdir()
    InstructorPin(config).set(PIN)
    return WatchedSimulator(serve(config=config), config, certificates)


@pytest.fixture
def open_board(loop_thread, tmp_path):
    """Open a board; opening a second board with the same settings restarts it."""
    opened = []

    def start(study=None) -> BoardClient:
        opened.append(BoardClient(loop_thread, tmp_path / "teacher", study))
        return opened[-1]

    yield start
    for board in opened:
        board.close()


@pytest.fixture
def board(open_board) -> BoardClient:
    return open_board()
