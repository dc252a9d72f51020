"""Servers on real sockets, and a client of them."""

import pytest

from rastrainer.igtl.client import Client
from rastrainer_simulator.net.igtl import outgoing, server, simulator_link
from rastrainer_simulator.net.limits import LinkLimits
from Testing.simulator.net.igtl.servers import LinkServer, PlainServer

LIMITED = (outgoing, server, simulator_link)


@pytest.fixture
def start(loop_thread, monkeypatch):
    """Starts servers of a kind with given limits, of a site or of ours, and ends them."""
    started = []

    def start_one(kind, first_message_s=0.02, **limits):
        ours = {"first_message_s": first_message_s, **limits}
        of_site = {name: ours.pop(name) for name in vars(LinkLimits()).keys() & ours.keys()}
        for name, value in ours.items():
            module = next(each for each in LIMITED if hasattr(each, name.upper()))
            monkeypatch.setattr(module, name.upper(), value)
        server = kind(loop_thread, LinkLimits(**of_site))
        started.append(server)
        return server

    yield start_one
    for one in started:
        loop_thread.run(one.server.close())


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
