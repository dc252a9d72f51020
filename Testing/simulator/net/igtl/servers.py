"""Servers on real sockets, in their own event loop, and the simulation's state by hand."""

import asyncio
import socket
import threading
from concurrent.futures import Future
from dataclasses import replace

import numpy as np

from rastrainer.igtl.content import CommandReply
from rastrainer.igtl.message import Message, MessageReader
from rastrainer.protocol import Proximity
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.net.igtl.server import IgtlServer
from rastrainer_simulator.net.igtl.simulator_link import SimulatorLink
from rastrainer_simulator.net.limits import LinkLimits
from rastrainer_simulator.state import Answer, Motion, SimulationState, TrainingState

HOST = "127.0.0.1"
PATIENCE_S = 60.0


class LoopThread:
    """An event loop in a thread, so that a test may block; it ends with the `with` statement."""

    def __enter__(self):
        self.loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self.loop.run_forever, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_exception):
        self.run(_end_all())
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join()
        self.loop.close()

    def run(self, coroutine, timeout=PATIENCE_S):
        """Return the result of a coroutine; raise RuntimeError if the loop has ended."""
        try:
            future = asyncio.run_coroutine_threadsafe(coroutine, self.loop)
        except RuntimeError:
            coroutine.close()
            raise
        return future.result(timeout)

    def call(self, function, *arguments, **named):
        async def called():
            return function(*arguments, **named)

        return self.run(called())


async def _end_all():
    """Cancel pending tasks, so that threads that wait for them continue."""
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)


class RecordingHandler:
    """Keeps what arrives; wakes threads that wait for it."""

    def __init__(self):
        self.news = threading.Condition()
        self.connections = []
        self.messages = []
        self.left = []

    def connected(self, connection):
        self._note(self.connections, connection)

    def received(self, _connection, message):
        self._note(self.messages, message)

    def disconnected(self, connection):
        self._note(self.left, connection)

    def wait_until(self, condition, timeout=PATIENCE_S):
        with self.news:
            assert self.news.wait_for(condition, timeout), "it did not happen"

    def wait_for_messages(self, count):
        self.wait_until(lambda: len(self.messages) >= count)
        return self.messages[:count]

    def _note(self, items, item):
        with self.news:
            items.append(item)
            self.news.notify_all()


class PlainServer:
    """An `IgtlServer` that only keeps what arrives."""

    def __init__(self, thread: LoopThread, limits: LinkLimits):
        self.thread = thread
        self.handler = RecordingHandler()
        self.server = thread.call(IgtlServer, self.handler, limits)
        self.port = thread.run(self.server.listen(HOST, 0))


class SimulatedLoop:
    """Replaces the control loop: gives prepared answers, and keeps the commands."""

    def __init__(self):
        self.latest = at_rest()
        self.commands = []
        self.unacknowledged = ()
        self.arrivals = 0
        self.answer = lambda name, _arguments: Answer(0, True, data={"did": name})

    def submit(self, name, arguments, sender):
        self.commands.append((name, dict(arguments), sender))
        future = Future()
        future.set_result(self.answer(name, arguments))
        return future


class LinkServer:
    """A `SimulatorLink` that listens."""

    def __init__(self, thread: LoopThread, limits: LinkLimits):
        self.thread = thread
        self.simulated = SimulatedLoop()
        simulated = self.simulated
        self.link = thread.call(
            SimulatorLink,
            lambda: simulated.latest,
            simulated.submit,
            lambda: simulated.unacknowledged,
            lambda: simulated.arrivals,
            lambda _name: load_scenario(asset_path("scenarios", "colin27")),
            limits=limits,
        )
        self.server = self.link.server
        self.port = thread.run(self.server.listen(HOST, 0))

    def publish(self, state: SimulationState) -> None:
        self.simulated.latest = state
        self.thread.call(self.link.publish, state)


def at_rest(**changes) -> SimulationState:
    state = SimulationState(
        tick=0,
        sim_time=0.0,
        q=(0.0,) * 7,
        tool_tip_to_world=np.eye(4),
        link_to_world=(np.eye(4),) * 8,
        head_to_world=np.eye(4),
        stand_to_world=np.eye(4),
        proximity=Proximity.FREE,
        clearance=0.1,
        training=TrainingState(),
        elapsed=0.0,
        motion=Motion.NONE,
        operator="",
        camera="far",
        planned_target=None,
    )
    return replace(state, **changes)


def answer_to(port: int, command: bytes) -> Message:
    """Send the bytes of one COMMAND and return the message that answers it."""
    reader = MessageReader()
    with socket.create_connection((HOST, port), 60) as peer:
        peer.sendall(command)
        while True:
            for message in reader.feed(peer.recv(65_536)):
                if type(message.content) is CommandReply:
                    return message
