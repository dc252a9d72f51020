"""Programs as separate processes that have already imported everything: many can be killed.

A nursery is a process that imports a program's modules and then forks. What it forks runs the
program's `main` and is a process like any other: with its own sockets, files and threads.
"""

from __future__ import annotations

import itertools
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

SCRIPT = """
import importlib, json, os, sys
program, *modules = sys.argv[1:]
main = importlib.import_module(program).main
for module in modules:
    importlib.import_module(module)
print("ready", flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    if "wait" in asked:
        print(os.waitstatus_to_exitcode(os.waitpid(asked["wait"], 0)[1]), flush=True)
        continue
    child = os.fork()
    if child == 0:
        os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
        os.dup2(os.open(asked["output"], os.O_WRONLY), 1)
        os._exit(main(asked["arguments"]))
    print(child, flush=True)
"""

SIMULATOR = (
    "rastrainer_simulator.cli.main",
    "rastrainer_simulator.cli.simulator",
    "rastrainer_simulator.ops.log_files",
    "rastrainer_simulator.server.server",
    "Testing.end_to_end.head_start",
)
SLICER_SIDE = ("rastrainer_headless.main",)
STUDY_SIDE = ("Testing.end_to_end.study_side",)


class Nursery:
    """Forks programs; ended by the `with` statement, and everything it has forked with it."""

    def __init__(self, program: tuple[str, ...], folder: Path):
        """Import a program; `folder` gets the pipes that its output comes through."""
        self._process = subprocess.Popen(
            [sys.executable, "-c", SCRIPT, *program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._folder = folder
        self._numbers = itertools.count()
        self._turn = threading.Lock()
        self._alive: dict[int, Forked] = {}
        assert self._process.stdout.readline() == "ready\n"

    def __enter__(self) -> Nursery:
        return self

    def __exit__(self, *_exception: object) -> None:
        for forked in tuple(self._alive.values()):
            forked.end()
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def fork(self, *arguments: str) -> Forked:
        """Start the program and return it."""
        pipe = self._folder / f"output-{self._process.pid}-{next(self._numbers)}"
        os.mkfifo(pipe)
        pid = self._ask({"arguments": arguments, "output": str(pipe)})
        self._alive[pid] = Forked(self, pid, pipe)
        return self._alive[pid]

    def end(self, pid: int, number: int) -> int:
        """Send a signal and return the exit status, negative for the signal that ended it."""
        del self._alive[pid]
        os.kill(pid, number)
        return self._ask({"wait": pid})

    def _ask(self, question: dict) -> int:
        with self._turn:
            self._process.stdin.write(json.dumps(question) + "\n")
            self._process.stdin.flush()
            return int(self._process.stdout.readline())


class Forked:
    """One program of a nursery.

    Attributes:
        pid: of its process.
    """

    def __init__(self, nursery: Nursery, pid: int, pipe: Path):
        self._nursery = nursery
        self.pid = pid
        self._output = pipe.open(encoding="utf-8")
        self._reader: threading.Thread | None = None

    def next_line(self) -> str:
        """Return the next line that it prints; "" once it has ended."""
        return self._output.readline().strip()

    def drain_output(self) -> None:
        """Read its output from now on: with a full pipe it would wait for a reader."""
        self._reader = threading.Thread(target=self._output.read, daemon=True)
        self._reader.start()

    def end(self, number: int = signal.SIGKILL) -> int:
        """End it and return its exit status."""
        status = self._nursery.end(self.pid, number)
        if self._reader is not None:
            self._reader.join()
        self._output.close()
        return status
