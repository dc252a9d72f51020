"""Servers on real sockets, and a client of them."""

import pytest

from rastrainer.igtl.client import Client
from rastrainer_simulator.net.limits import LinkLimits
from Testing.simulator.net.igtl.servers import LinkServer, PlainServer


@pytest.fixture
def start(loop_thread):
    """Starts servers of a kind with given limits, and ends them."""
    started = []

    def start_one(kind, first_message_s=0.02, **limits):
        server = kind(loop_thread, LinkLimits(first_message_s=first_message_s, **limits))
        started.append(server)
        return server

    yield start_one
    for server in started:
        loop_thread.run(server.server.close())


@pytest.fixture
def plain_server(start) -> PlainServer:
    return start(PlainServer)


@pytest.fixture
def link_server(start) -> LinkServer:
    return start(LinkServer)


@pytest.fixture
def client(link_server) -> Client:
    with Client(port=link_server.port) as client:
        yield client
