"""One whole tick of the simulation, and how punctual 250 of them a second are in the server."""

import dataclasses
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
from rastrainer.head.mesh import HeadMesh, read_head_mesh, write_head_mesh
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.state import NEUTRAL_STICKS, Motion, OperatorCommand, OperatorInput
from Testing.benchmarks.loop_health import WatchedLoop
from Testing.benchmarks.procedure_ticks import procedure_rows
from Testing.benchmarks.row import resident_mb, row, row_of_figures
from Testing.end_to_end.simulator_process import SimulatorProcess

DT = 0.004
SEED = 7
ON_TIME_S = 600.0
QUICK_S = 20.0
GOOD_CLIENTS = 3
ABOVE = np.array([0.0, 0.0, 165.0])


def rows(quick: bool) -> list[dict]:
    """Return the rows `tick.60k` and `tick.200k`, a procedure's rows, and the loop's.

    See `procedure_rows` and `_on_time`.
    """
    runs = 1 if quick else 5
    setup = load_setup()
    with tempfile.TemporaryDirectory() as folder:
        fine = _with_finer_head(setup, Path(folder) / "head.ply")
        ticks = [_tick("tick.60k", setup, runs), _tick("tick.200k", fine, runs)]
    ticks += procedure_rows(setup, runs)
    return [*ticks, *_on_time(QUICK_S if quick else ON_TIME_S)]


def _tick(name: str, setup: SimulationSetup, runs: int) -> dict:
    """Return a row; success is the share of all ticks that took less than 4 ms.

    A tick's time is the median of the runs, which all do the same work at it: what else the machine
    did in one of them does not count.
    """
    tours = 1e3 * _tick_times(setup, runs)
    in_time = float((tours < 1e3 * DT).mean())
    return row(name, np.median(tours, axis=0), "ms", success=in_time)


def _with_finer_head(setup: SimulationSetup, path: Path) -> SimulationSetup:
    """Return the setup with each triangle of the head cut into four."""
    mesh = read_head_mesh(setup.scenario.head)
    edges = np.sort(mesh.sides, axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = len(mesh.vertices) + index.reshape(3, -1)
    a, b, c = mesh.triangles.T
    triangles = np.concatenate(
        [np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))]
    )
    vertices = np.concatenate([mesh.vertices, mesh.vertices[unique].mean(axis=1)])
    write_head_mesh(path, HeadMesh(vertices, triangles))
    return dataclasses.replace(setup, scenario=dataclasses.replace(setup.scenario, head=path))


def _tick_times(setup: SimulationSetup, runs: int) -> np.ndarray:
    """Return (runs, n) float: the time of each tick in s of the same tour, again and again."""
    simulation = Simulation(setup, SEED)
    gc.collect()
    gc.freeze()
    try:
        tours = [_tour(simulation) for _ in range(runs)]
    finally:
        gc.unfreeze()
    shortest = min(map(len, tours))
    return np.array([tour[:shortest] for tour in tours])


def _tour(simulation: Simulation) -> np.ndarray:
    """Return the time of each tick in s: to each fiducial of a task, pressing on the skin there."""
    times: list[float] = []

    def step(operator_input: OperatorInput) -> None:
        begin = time.perf_counter()
        simulation.step(DT, operator_input)
        times.append(time.perf_counter() - begin)

    def do(command: str, **arguments: object) -> None:
        checked = check_arguments(command, arguments)
        step(OperatorInput(commands=(OperatorCommand(command, checked),)))

    def move_to(position: np.ndarray) -> None:
        do(CommandName.MOVE_TIP_TO, positionMm=position.tolist(), speedMmS=250.0)
        while simulation.state.motion is not Motion.NONE:
            step(NEUTRAL_STICKS)

    random = np.random.default_rng(SEED)
    do(CommandName.START_TASK, task="task-3", trainee="bench", seed=SEED)
    truth = simulation.truth
    center = truth.in_world(truth.target_ras)
    for label in truth.fiducials_ras:
        fiducial = truth.in_world(truth.fiducials_ras[label])
        outside = fiducial + 70.0 * (fiducial - center) / np.linalg.norm(fiducial - center)
        move_to(outside)
        move_to(fiducial)
        for _ in range(10):
            stick = OperatorInput(translation=tuple(random.uniform(-1.0, 1.0, 3).tolist()))
            for _ in range(15):
                step(stick)
        move_to(outside)
        move_to(center + ABOVE)
    do(CommandName.ABORT)
    return np.array(times)


def _on_time(duration_s: float) -> list[dict]:
    """Return the rows of the server's loop with five clients and a trial being written.

    Three clients watch and one of them jogs; one never reads, one sends garbage. Of `loop.on_time`
    median and p99 are of each second's share of ticks within 1 ms of their time, `success` is that
    of all ticks. `loop.memory` is how much the resident memory grew from the second tenth of the
    time to the last: median against median, and the most against the most.
    """
    with (
        tempfile.TemporaryDirectory() as records,
        SimulatorProcess(Path(records)) as simulator,
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
    """Connect the clients that behave well; return a client that jogs and a client that does
    not."""
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
    """Keep a client that never reads and a client that sends garbage, each back as soon as
    dropped."""
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
