"""The simulator's process with a virtual gamepad plugged in, which tests use over a pipe.

As a module, it is that process: `python -m Testing.end_to_end.virtual_gamepad FELT simulator …`
attaches the gamepad to its own SDL and otherwise runs the ordinary `rastrainer simulator …`.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from queue import SimpleQueue
from typing import Any

from rastrainer_simulator.cli.main import main as run
from rastrainer_simulator.input.gamepads import GamepadNews, Gamepads
from rastrainer_simulator.loop.timing import raise_thread_priority
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.sdl_virtual_gamepad import VirtualGamepad

REPOSITORY = Path(__file__).parents[2]


class SimulatorWithGamepad(SimulatorProcess):
    """`rastrainer simulator` with a gamepad.

    Every move has been sent when its call returns; moves are made in order. `tap` holds
    its button until the simulator has read it, however busy the computer is.
    """

    command = (sys.executable, "-m", "Testing.end_to_end.virtual_gamepad")

    def __init__(self, records: Path, *arguments: str):
        self._felt = records.with_name(records.name + "-felt.jsonl")
        self._felt.parent.mkdir(parents=True, exist_ok=True)
        self._felt.touch()
        self.command = (*self.command, str(self._felt), "simulator")
        # Else pygame greets on the standard output, where the simulator's lines are read.
        environment = {**os.environ, "PYGAME_HIDE_SUPPORT_PROMPT": "1"}
        others = {"stdin": subprocess.PIPE, "cwd": REPOSITORY, "env": environment}
        super().__init__(records, *arguments, **others)

    def plug_in(self) -> None:
        """Plug the gamepad in, as at first."""
        self._send({"plug": True})

    def unplug(self) -> None:
        """Plug the gamepad out."""
        self._send({"plug": False})

    def move(self, **positions: float) -> None:
        """Push axes by SDL's names ("leftx", …): sticks −1…1, triggers 0…1."""
        self._send({"move": positions})

    def press(self, button: str, is_down: bool = True) -> None:
        """Press a button by SDL's name ("a", "dpdown", …), or release it."""
        self._send({"press": button, "isDown": is_down})

    def tap(self, button: str, seconds: float = 0.0) -> None:
        """Press a button for at least this time, and release it."""
        self._send({"tap": button, "seconds": seconds})

    def felt(self) -> list[tuple[float, float]]:
        """Return the strengths (0 to 1) of both motors at each of SDL's calls so far."""
        return [tuple(json.loads(line)) for line in self._felt.read_text().splitlines()]

    def _send(self, order: dict[str, Any]) -> None:
        self._process.stdin.write(json.dumps(order) + "\n")
        self._process.stdin.flush()


class Plug:
    """Plugs the gamepad in and out in the thread that polls gamepads, before it polls.

    In any other thread SDL would call back to Python while the polling thread holds a lock that
    both need: a deadlock.
    """

    def __init__(self, gamepad: VirtualGamepad):
        self._gamepad = gamepad
        self._orders: SimpleQueue[tuple[bool, threading.Event]] = SimpleQueue()
        look = Gamepads.poll

        def plug_and_look(gamepads: Gamepads) -> Iterator[GamepadNews]:
            self._carry_out()
            yield from look(gamepads)

        Gamepads.poll = plug_and_look

    def order(self, is_in: bool) -> None:
        """Plug it in or out, and wait until that is done."""
        is_done = threading.Event()
        self._orders.put((is_in, is_done))
        is_done.wait()

    def _carry_out(self) -> None:
        while not self._orders.empty():
            is_in, is_done = self._orders.get()
            (self._gamepad.plug_in if is_in else self._gamepad.unplug)()
            is_done.set()


def main() -> int:
    """Run the ordinary program, and obey the pipe."""
    felt = Path(sys.argv[1])
    threading.Thread(target=_obey, args=(felt,), daemon=True).start()
    return run(sys.argv[2:])


def _obey(path: Path) -> None:
    # A real gamepad's driver does not hold the interpreter either when the control loop is due.
    raise_thread_priority()
    with path.open("a", buffering=1) as felt:
        gamepad = VirtualGamepad(lambda *strengths: felt.write(json.dumps(strengths) + "\n"))
        plug = Plug(gamepad)
        plug.order(True)
        for line in sys.stdin:
            order = json.loads(line)
            if "plug" in order:
                plug.order(order["plug"])
            elif "move" in order:
                gamepad.move(**order["move"])
            elif "tap" in order:
                gamepad.tap(order["tap"], order["seconds"])
            else:
                gamepad.press(order["press"], order["isDown"])


if __name__ == "__main__":
    sys.exit(main())
