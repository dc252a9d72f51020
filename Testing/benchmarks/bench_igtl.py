"""The link's delay compared with pyigtl's, and the cost of the server's process."""

import os
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Transform
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.protocol import PROTOCOL_VERSION
from Testing.benchmarks.row import cpu_share, resident_mb, row
from Testing.end_to_end.simulator_process import StartedSimulator

PROBE = Message("Echo", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 10, 20, 30)))
PAUSE_S = 0.013
"""The pause between two probes: about the period of a tracker, and no divisor of any server's
rate."""
TIMEOUT_S = 1.0

PYIGTL_ECHO = """
import sys, time, pyigtl
server = pyigtl.OpenIGTLinkServer(int(sys.argv[1]))
print("ready", flush=True)
while True:
    for message in server.get_latest_messages():
        server.send_message(message, wait=False)
    time.sleep(0.0002)
"""


def rows(quick: bool) -> list[dict]:
    """Return the rows `igtl.echo`, `server.start`, `server.rss` and `server.cpu`."""
    with tempfile.TemporaryDirectory() as records, tempfile.TemporaryDirectory() as compiled:
        # As users start it: from modules that an earlier start has compiled.
        os.environ["PYTHONPYCACHEPREFIX"] = compiled
        os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
        _start_time(Path(records))
        starts = [_start_time(Path(records)) for _ in range(2 if quick else 5)]
        with StartedSimulator(Path(records)) as simulator, Client(port=simulator.port) as slicer:
            hello = {"protocolVersion": PROTOCOL_VERSION, "client": "3D Slicer"}
            slicer.send_command("Hello", hello)
            echoes = 1e3 * np.array(_echo_times(simulator.port, 100 if quick else 1000))
            cpu = [cpu_share(simulator.pid, 1.0) for _ in range(3 if quick else 20)]
            rss = resident_mb(simulator.pid)
    peer = _pyigtl_echo_times(50 if quick else 300)
    return [
        row(
            "igtl.echo",
            echoes,
            "ms",
            "pyigtl",
            1e3 * np.array(peer),
            success=float(np.isfinite(echoes).mean()),
        ),
        row("server.start", starts, "s"),
        row("server.rss", [rss], "MB"),
        row("server.cpu", 100.0 * np.array(cpu), "%"),
    ]


def _start_time(records: Path) -> float:
    begin = time.perf_counter()
    with StartedSimulator(records):
        return time.perf_counter() - begin


def _pyigtl_echo_times(count: int) -> list[float]:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        port = probe.getsockname()[1]
    command = [sys.executable, "-c", PYIGTL_ECHO, str(port)]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as server:
        try:
            server.stdout.readline()
            return _echo_times(port, count)
        finally:
            server.kill()


def _echo_times(port: int, count: int) -> list[float]:
    """Return the delay of each probe in s, NaN where no echo came."""
    data = pack(PROBE)
    reader = MessageReader()
    with socket.create_connection(("127.0.0.1", port)) as peer:
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        peer.settimeout(TIMEOUT_S)
        return [_echo_time(peer, reader, data) for _ in range(count)]


def _echo_time(peer: socket.socket, reader: MessageReader, data: bytes) -> float:
    time.sleep(PAUSE_S)
    begin = time.perf_counter()
    peer.sendall(data)
    try:
        while True:
            messages = reader.feed(peer.recv(65_536))
            if any(message.device == PROBE.device for message in messages):
                return time.perf_counter() - begin
    except TimeoutError:
        return float("nan")
