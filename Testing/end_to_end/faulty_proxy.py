"""A TCP proxy with the faults of networks: they are seeded, and bytes keep their order.

TCP keeps the order within a connection. Two connections have no order: data sent over a connection
that was cut may arrive after data sent over the next.
"""

from __future__ import annotations

import contextlib
import random
import select
import socket
import struct
import threading
import time
from dataclasses import dataclass, replace

from rastrainer.sections.trial_services import TrialServices
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.study.database.study import Study
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.scene import HeadlessScene
from Testing.slicer.simulator_double import process_link

PIECE_BYTES = 16_384
TOO_FEW_BYTES = 1_000
"""The record of a trial is longer."""
HOST = "127.0.0.1"


@dataclass(frozen=True)
class Fault:
    """The fate of one connection.

    Attributes:
        after_bytes: of both directions together.
        kind: "cut" (closed), "reset", "half-open" (both ends stay open, nothing passes), or
            "late" (the client is cut, and its last data arrive only later).
        lasts_s: duration of a half-open link, or delay of late data.
        delay_s: delay of every piece that passes.
    """

    after_bytes: int
    kind: str
    lasts_s: float
    delay_s: float


def draw_fault(rng: random.Random, longest_s: float) -> Fault:
    """Return the fate of a connection."""
    return Fault(
        after_bytes=int(10.0 ** rng.uniform(2.0, 5.0)),
        kind=rng.choice(["cut", "reset", "half-open", "late"]),
        lasts_s=rng.uniform(0.0, longest_s),
        delay_s=rng.choice([0.0, 0.0, rng.uniform(0.0, 0.02)]),
    )


class FaultyProxy:
    """Stands between clients and a server; ended by `close`.

    Attributes:
        port: where clients connect.
        target: port of the server, which may change.
        faults: how many connections had each kind of end.
    """

    def __init__(self, target: int, rng: random.Random, longest_s: float, at_least: int = 0):
        """Until `at_least` faults have struck, no connection lasts for a whole trial."""
        self.target = target
        self.faults: dict[str, int] = {}
        self._rng = rng
        self._longest_s = longest_s
        self._at_least = at_least
        self._is_fault_free = threading.Event()
        self._is_closed = threading.Event()
        self._listener = socket.create_server((HOST, 0))
        self.port = self._listener.getsockname()[1]
        self._threads = [threading.Thread(target=self._accept)]
        self._threads[0].start()

    def stop_faults(self) -> None:
        """Cut nothing from now on, so that the rest can be delivered."""
        self._is_fault_free.set()

    def close(self) -> None:
        """Cut all and end."""
        self._is_closed.set()
        with contextlib.suppress(OSError):
            self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        for thread in self._threads:
            thread.join()

    def _accept(self) -> None:
        while not self._is_closed.is_set():
            try:
                client = self._listener.accept()[0]
            except OSError:
                return
            fault = draw_fault(self._rng, self._longest_s)
            if sum(self.faults.values()) < self._at_least:
                fault = replace(fault, after_bytes=min(fault.after_bytes, TOO_FEW_BYTES))
            thread = threading.Thread(target=self._carry, args=(client, fault))
            self._threads.append(thread)
            thread.start()

    def _carry(self, client: socket.socket, fault: Fault) -> None:
        try:
            server = socket.create_connection((HOST, self.target), 60)
        except OSError:
            client.close()
            return
        with client, server:
            late = self._pass_on(client, server, fault)
            if late is not None:
                self.faults[fault.kind] = self.faults.get(fault.kind, 0) + 1
                with contextlib.suppress(OSError):
                    self._strike(client, server, fault, late)

    def _pass_on(self, client: socket.socket, server: socket.socket, fault: Fault) -> bytes | None:
        """Carry bytes in both directions; None if a peer has left.

        Once the fault strikes, usually within a message, return the client's data that the server
        has not received.
        """
        other = {client: server, server: client}
        left = fault.after_bytes
        while not self._is_closed.is_set():
            for source in select.select([client, server], [], [], 0.05)[0]:
                try:
                    data = source.recv(PIECE_BYTES)
                    if not data:
                        return None
                    if len(data) > left and not self._is_fault_free.is_set():
                        other[source].sendall(data[:left])
                        return data[left:] if source is client else b""
                    self._is_closed.wait(fault.delay_s)
                    other[source].sendall(data)
                    left = max(0, left - len(data))
                except OSError:
                    return None
        return None

    def _strike(
        self, client: socket.socket, server: socket.socket, fault: Fault, late: bytes
    ) -> None:
        if fault.kind == "half-open":
            self._is_closed.wait(fault.lasts_s)
        if fault.kind == "late":
            client.setblocking(False)
            with contextlib.suppress(BlockingIOError):
                late += client.recv(PIECE_BYTES)
            client.close()
            self._is_closed.wait(fault.lasts_s)
            server.sendall(late)
            # The server still answers, but no one listens.
            self._is_closed.wait(0.05)
        if fault.kind == "reset":
            for peer in (client, server):
                peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


class SlicerSide:
    """Slicer's side, headless; closes the logic that `make_logic` returns."""

    def __init__(self, path, port, make_logic, find_scenario=None, records=None):
        scene = HeadlessScene().scene
        self.link = Link(scene, headlessKit)
        self.work = BackgroundWork()
        services = TrialServices(
            scene, self.link, find_scenario, lambda: Study.open(path), self.work, records
        )
        self.logic = make_logic(services)
        self.link.connectTo(port=port)

    def run_for(self, steps):
        for _ in range(steps):
            process_link(self.link)
            self.work.process()
            time.sleep(0.002)

    def close(self):
        self.logic.close()
        self.work.close()
        self.link.disconnect()
