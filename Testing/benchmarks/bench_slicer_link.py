"""What module and connection cost Slicer: renderings, processor time, and a command's delay.

Measured in the tests' host, which counts renderings but draws nothing, with a real simulator's
process.
"""

import tempfile
import time
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

from PySide6 import QtCore

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.link.link_status import LinkState
from Testing.benchmarks.row import row
from Testing.end_to_end.simulator_process import StartedSimulator
from Testing.slicer.host.host import Host

STROKE_S = 2.0
SPEED_MM_S = 20.0
SETTLE_S = 2.0
PIECE_S = 1.0


class Cost:
    """The cost of each second.

    Attributes:
        renders: renderings a second.
        cpu: share of a core, %; it includes the host, which looks for messages every 5 ms.
    """

    def __init__(self, host: Host, seconds: int, before: Callable[[], None] = lambda: None) -> None:
        self.renders: list[float] = []
        self.cpu: list[float] = []
        for _ in range(seconds):
            before()
            renders, used, begin = host.renders, time.process_time(), time.perf_counter()
            _idle_for(PIECE_S)
            passed = time.perf_counter() - begin
            self.renders.append((host.renders - renders) / passed)
            self.cpu.append(100.0 * (time.process_time() - used) / passed)


def rows(quick: bool) -> list[dict]:
    """Return the rows `slicer.*`."""
    seconds = 4 if quick else 20
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory()))
        simulator = stack.enter_context(StartedSimulator(folder / "records"))
        player = stack.enter_context(Client(port=simulator.port))
        host = Host(folder / "slicer")
        stack.callback(host.close)
        session = host.open().logic.session
        _idle_for(SETTLE_S)
        apart = Cost(host, seconds)
        host.leave()
        _idle_for(SETTLE_S)
        away = Cost(host, seconds)
        host.enter()
        session.link.connectTo("127.0.0.1", simulator.port)
        host.wait_until(lambda: session.link.status.state is LinkState.CONNECTED, "it connects")
        _idle_for(SETTLE_S)
        idle = Cost(host, seconds)
        delays = [_command_delay(session.link) for _ in range(5 * seconds)]
        host.check("robotCheckBox")
        host.finish_work()
        _start_trial(player)
        _idle_for(SETTLE_S)
        moving = Cost(host, seconds, _mover(player))
    return [
        row("slicer.renders idle", idle.renders, "1/s", "disconnected", apart.renders),
        row("slicer.renders moving", moving.renders, "1/s"),
        row("slicer.cpu open", apart.cpu, "%", "another module", away.cpu),
        row("slicer.cpu idle", idle.cpu, "%", "disconnected", apart.cpu),
        row("slicer.cpu moving", moving.cpu, "%", "disconnected", apart.cpu),
        row("slicer.command", delays, "ms"),
    ]


def _idle_for(seconds: float) -> None:
    """Run Qt's event loop, as Slicer does; it sleeps while nothing is due."""
    loop = QtCore.QEventLoop()
    QtCore.QTimer.singleShot(round(1000 * seconds), loop.quit)
    loop.exec()


def _command_delay(link) -> float:
    """Return the time from a command to its reply, ms."""
    loop, begin = QtCore.QEventLoop(), time.perf_counter()
    link.send(CommandName.LIST_TASKS, onReply=lambda _reply: loop.quit())
    loop.exec()
    return 1e3 * (time.perf_counter() - begin)


def _start_trial(player: Client) -> None:
    _do(player, CommandName.HELLO, {"protocolVersion": PROTOCOL_VERSION, "client": "player"})
    _do(player, CommandName.START_TASK, {"task": "task-1", "trainee": "T-001"})


def _mover(player: Client) -> Callable[[], None]:
    """Return a function that jogs the arm up or down for longer than `PIECE_S`."""
    directions = [1.0, -1.0]

    def move() -> None:
        directions.reverse()
        velocity = [0.0, 0.0, SPEED_MM_S * directions[0]]
        _do(player, CommandName.JOG, {"velocityMmS": velocity, "durationS": STROKE_S})

    return move


def _do(player: Client, name: str, arguments: dict) -> None:
    reply = player.send_command(name, arguments)
    if not reply.ok:
        raise RuntimeError(f"{name}: {reply.error}")
