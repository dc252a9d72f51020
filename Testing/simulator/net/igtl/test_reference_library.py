"""The C++ reference library as our client: every type, in both directions, and hostile input."""

import asyncio
import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rastrainer.igtl.content import Command, Point, Points, Status, String, Transform
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.net.igtl import server as link_server
from rastrainer_simulator.net.limits import LinkLimits
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.trial_state import TouchState
from Testing.simulator.net.igtl.servers import LinkServer, at_rest

SOURCE = Path(__file__).with_name("reference_client.cpp")
HEADERS = Path("/usr/include/openigtlink")
TIP = np.array([[0, -1, 0, 0.5], [1, 0, 0, -0.25], [0, 0, 1, 0.125], [0, 0, 0, 1]])
TOUCH = TouchState("1", (0.5, -0.25, 0.125), 1.0, 1.0)


@pytest.fixture(scope="module")
def reference_client(tmp_path_factory) -> Path:
    """Our client of the reference library, compiled."""
    if sys.platform != "linux":
        pytest.skip("the library is Debian's package")
    assert shutil.which("g++"), "Install a C++ compiler: apt-get install g++"
    assert HEADERS.is_dir(), "Install the reference library: apt-get install libopenigtlink-dev"
    program = tmp_path_factory.mktemp("reference") / "reference_client"
    command = ["g++", "-std=c++11", "-w", f"-I{HEADERS}", str(SOURCE), "-o", str(program)]
    subprocess.run([*command, "-lOpenIGTLink", "-lpthread"], check=True)
    return program


@pytest.fixture(scope="module", params=["", "hostile"], ids=["good", "hostile"])
def exchange(reference_client, loop_thread, request):
    """What each side read of the other: our server's messages, and the client's lines by device.

    A hostile client sends what cannot be used before all else: that costs it and others nothing.
    """

    patch = pytest.MonkeyPatch()
    # However late its first message is: it would not understand one of version 2.
    patch.setattr(link_server, "FIRST_MESSAGE_S", 600.0)
    server = LinkServer(loop_thread, LinkLimits())
    server.simulated.latest = at_rest(
        tool_tip_to_world=TIP, training=TrainingState(trial_id="id-1", touches=(TOUCH,))
    )
    taken = []
    receive = server.link.received

    def keep_and_receive(connection, message):
        taken.append(message)
        receive(connection, message)

    server.link.received = keep_and_receive
    beat = asyncio.run_coroutine_threadsafe(server.link.beat(), loop_thread.loop)
    process = subprocess.Popen(
        [reference_client, str(server.port), *request.param.split()],
        stdout=subprocess.PIPE,
        text=True,
    )
    sim_time = 0.0
    while process.poll() is None:
        sim_time += 0.02
        state = server.simulated.latest
        server.publish(at_rest(sim_time=sim_time, tool_tip_to_world=TIP, training=state.training))
        try:
            process.wait(0.02)
        except subprocess.TimeoutExpired:
            continue
    output = process.stdout.read()
    beat.cancel()
    loop_thread.run(server.server.close())
    patch.undo()
    assert process.returncode == 0, output
    lines = [line.split(" ", 2) for line in output.splitlines()]
    return {message.device: message for message in taken}, {line[1]: line for line in lines}


SENT = {
    "Reference": Transform((0, 1, 0, -1, 0, 0, 0, 0, 1, 10.5, -20.25, 300.125)),
    "Note": String("touch point 3"),
    "Points": Points((Point("7", (1.5, -2, 3.25), (1, 2, 3, 255)),)),
    "Device": Status(1, 42, "none", "well"),
    "command": Command(4711, "Hello", '{"protocolVersion": 1, "client": "reference"}'),
}


def test_messages_sent_by_the_reference_library_are_read(exchange):
    taken, _lines = exchange
    assert {device: taken[device].content for device in SENT} == SENT


def test_the_reference_library_reads_the_published_state_and_the_answers(exchange):
    _taken, lines = exchange
    assert lines["Reference"][2] == "0 -1 0 10.5 1 0 0 -20.25 0 0 1 300.125"
    assert lines["ToolTipToWorld"][::2] == ["TRANSFORM", "0 -1 0 500 1 0 0 -250 0 0 1 125"]
    assert lines["CapturedPoints"][::2] == ["POINT", "1 500 -250 125"]
    kind, _device, text = lines["SimState"]
    assert (kind, json.loads(text)["trialId"]) == ("STRING", "id-1")
    kind, _device, text = lines["SimServer"]
    code, subcode, message = text.split(" ", 2)
    assert (kind, code, int(subcode)) == ("STATUS", "1", PROTOCOL_VERSION)
    assert json.loads(message)["protocolVersion"] == PROTOCOL_VERSION
    kind, _device, text = lines["command"]
    number, name, body = text.split(" ", 2)
    assert (kind, number, name) == ("RTS_COMMAND", "4711", "Hello")
    assert json.loads(body)["server"] == "RASTrainer simulator"
