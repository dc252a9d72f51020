"""One whole tick of the simulation, and how punctual 250 of them a second are in the server."""

import gc
import os
import socket
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from rastrainer.commands import CommandName, check_arguments
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.state import NEUTRAL_STICKS, Motion, OperatorCommand, OperatorInput
from Testing.benchmarks.loop_health import WatchedLoop
from Testing.benchmarks.row import resident_mb, row, row_of_figures
from Testing.end_to_end.simulator_process import StartedSimulator

DT = 0.004
SEED = 7
ON_TIME_S = 600.0
QUICK_S = 20.0
GOOD_CLIENTS = 3
ABOVE = np.array([0.0, 0.0, 165.0])
TRIAL_ID = "00000000-0000-4000-8000-000000000000"


def rows(quick: bool) -> list[dict]:
    """Return the row `tick.60k`, and the loop's: see `_on_time`."""
    return [_tick_row(1 if quick else 5), *_on_time(QUICK_S if quick else ON_TIME_S)]


class _Timed:
    """A simulation, and the times of its ticks, s."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.ticks: list[float] = []

    def step(self, operator_input: OperatorInput) -> None:
        begin = time.perf_counter()
        result = self.simulation.step(DT, operator_input)
        self.ticks.append(time.perf_counter() - begin)
        refused = [answer.message for answer in result.answers if not answer.ok]
        assert not refused, refused

    def do(self, command: str, **arguments: object) -> None:
        checked = check_arguments(command, arguments)
        if command == CommandName.START_TASK:
            checked["trialId"] = TRIAL_ID
        self.step(OperatorInput(commands=(OperatorCommand(command, checked),)))

    def wait(self) -> None:
        """Step until the arm is still."""
        while self.simulation.state.motion is not Motion.NONE:
            self.step(NEUTRAL_STICKS)

    def push(self, random: np.random.Generator) -> None:
        """Push the sticks at random, ten times for 15 ticks."""
        for _ in range(10):
            pushed = OperatorInput(tuple(random.uniform(-1.0, 1.0, 3).tolist()), (0.0, 0.0))
            for _ in range(15):
                self.step(pushed)


def _tick_row(runs: int) -> dict:
    """Return the row of a tour's ticks; success is the share that took less than 4 ms.

    A tick's time is the median of the runs, which all do the same work: other load of the machine
    in a single run does not count.
    """
    simulation, played = Simulation(load_setup(), SEED), []
    gc.collect()
    gc.freeze()
    try:
        for _ in range(runs):
            played.append(_Timed(simulation))
            _tour(played[-1])
    finally:
        gc.unfreeze()
    shortest = min(len(each.ticks) for each in played)
    same = 1e3 * np.array([each.ticks[:shortest] for each in played])
    in_time = float((same < 1e3 * DT).mean())
    return row("tick.60k", np.median(same, axis=0), "ms", success=in_time)


def _tour(timed: _Timed) -> None:
    """Go to each fiducial of a task, pressing on the skin there."""

    def move_to(position: np.ndarray) -> None:
        timed.do(CommandName.MOVE_TIP_TO, positionMm=position.tolist(), speedMmS=250.0)
        timed.wait()

    random = np.random.default_rng(SEED)
    timed.do(CommandName.START_TASK, task="task-3", trainee="bench", seed=SEED)
    truth = timed.simulation.truth
    center = truth.in_world(truth.target_ras)
    for place in truth.fiducials_ras.values():
        fiducial = truth.in_world(place)
        outside = fiducial + 70.0 * (fiducial - center) / np.linalg.norm(fiducial - center)
        move_to(outside)
        move_to(fiducial)
        timed.push(random)
        move_to(outside)
        move_to(center + ABOVE)
    timed.do(CommandName.ABORT)


def _on_time(duration_s: float) -> list[dict]:
    """Return the rows of the server's loop with five clients and a trial being written.

    Three clients watch and one of them jogs; one never reads, one sends garbage. `loop.on_time`
    is the share of ticks within 1 ms of their time: median and p99 over the seconds, `success`
    over all ticks. `loop.memory` is how much the resident memory grew from the second tenth of the
    time to the last: median against median, and maximum against maximum.
    """
    with (
        tempfile.TemporaryDirectory() as records,
        StartedSimulator(Path(records)) as simulator,
        _annoyed(simulator.port),
        _clients(simulator.port) as (jogger, watcher),
        WatchedLoop(watcher) as watched,
    ):
        jogger.send_command(CommandName.START_TASK, {"task": "task-1", "trainee": "bench"})
        memory = []
        until = time.monotonic() + duration_s
        while time.monotonic() < until:
            _jog_for_a_second(jogger)
            memory.append(resident_mb(simulator.pid))
    tenth = max(len(memory) // 10, 1)
    early, late = memory[tenth : 2 * tenth], memory[-tenth:]
    growth = (np.median(late) - np.median(early), max(late) - max(early))
    memory_row = row_of_figures("loop.memory", growth, "MB", n=len(memory))
    return [watched.row("loop.on_time"), memory_row]


def _jog_for_a_second(client: Client) -> None:
    for number in range(20):
        velocity = [60.0 * (-1) ** (number // 5), 30.0 * (-1) ** (number // 2), 0.0]
        client.send_command(CommandName.JOG, {"velocityMmS": velocity, "durationS": 0.06})
        time.sleep(0.05)


@contextmanager
def _clients(port: int) -> Iterator[tuple[Client, Client]]:
    """Connect the clients that behave well; yield a client that jogs and another client."""
    clients = [Client(port=port) for _ in range(GOOD_CLIENTS)]
    try:
        for client in clients:
            hello = {"protocolVersion": PROTOCOL_VERSION, "client": "bench", "steady": True}
            client.send_command(CommandName.HELLO, hello)
        yield clients[0], clients[1]
    finally:
        for client in clients:
            client.close()


@contextmanager
def _annoyed(port: int) -> Iterator[None]:
    """Run a client that never reads and a client that sends garbage; both reconnect if dropped."""
    is_over = threading.Event()

    def never_read() -> None:
        while not is_over.is_set():
            with suppress(OSError), socket.create_connection(("127.0.0.1", port)) as peer:
                while not is_over.wait(1.0):
                    peer.sendall(b"")

    def send_garbage() -> None:
        while not is_over.is_set():
            with suppress(OSError), socket.create_connection(("127.0.0.1", port)) as peer:
                while not is_over.wait(0.05):
                    peer.sendall(os.urandom(2000))

    threads = [threading.Thread(target=target) for target in (never_read, send_garbage)]
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        is_over.set()
        for thread in threads:
            thread.join()
