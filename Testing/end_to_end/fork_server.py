"""Programs as separate processes that have already imported everything: many can be killed.

A fork server is a process that imports a program's modules and then forks. What it forks runs the
program's `main` and is a process like any other: with its own sockets, files and threads.
"""

from __future__ import annotations

import atexit
import itertools
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from functools import cache
from pathlib import Path

SCRIPT = """
import importlib, json, os, signal, sys
program, *modules = sys.argv[1:]
main = importlib.import_module(program).main
for module in modules:
    importlib.import_module(module)
# Even if the tests run in the background, which ignores both.
signal.signal(signal.SIGHUP, signal.SIG_DFL)
signal.signal(signal.SIGINT, signal.default_int_handler)
print("ready", flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    if "wait" in asked:
        pid, status = os.waitpid(asked["wait"], os.WNOHANG)
        print(json.dumps(os.waitstatus_to_exitcode(status) if pid else None), flush=True)
        continue
    child = os.fork()
    if child == 0:
        os.chdir(asked["folder"])
        os.environ.clear()
        os.environ.update(asked["environment"])
        for number, path in enumerate((os.devnull, asked["output"], asked["errors"])):
            if path:
                os.dup2(os.open(path, os.O_WRONLY | os.O_APPEND if number else os.O_RDONLY), number)
        exec(asked["first"])
        os._exit(main(asked["arguments"]))
    print(child, flush=True)
"""
LOOK_S = 0.01

SIMULATOR = (
    "rastrainer_simulator.cli.main",
    "rastrainer_simulator.cli.simulator",
    "rastrainer_simulator.ops.log_files",
    "rastrainer_simulator.server.server",
    "rastrainer_simulator.net.views.view_server",
    "rastrainer_simulator.flow.flow_presenter",
    "Testing.end_to_end.head_start",
)
SLICER_SIDE = ("rastrainer_headless.main",)
STUDY_SIDE = ("Testing.end_to_end.study_side",)


class ForkServer:
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
        self._forked: list[Forked] = []
        assert self._process.stdout.readline() == "ready\n"

    def __enter__(self) -> ForkServer:
        return self

    def __exit__(self, *_exception: object) -> None:
        for forked in self._forked:
            forked.kill()
        self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()

    def fork(
        self,
        *arguments: str,
        errors: str = "",
        first: str = "",
        env: Mapping[str, str] | None = None,
    ) -> Forked:
        """Start the program in this process's folder, and in its environment or `env`; return it.

        Its stderr is appended to the file `errors`, or goes where our own goes. `first` is done
        before its `main`, in Python.
        """
        pipe = self._folder / f"output-{self._process.pid}-{next(self._numbers)}"
        os.mkfifo(pipe)
        places = {"folder": str(Path.cwd()), "output": str(pipe), "errors": errors}
        done = {"first": first, "arguments": arguments, "environment": dict(env or os.environ)}
        pid = self.ask({**places, **done})
        self._forked.append(Forked(self, pid, pipe))
        return self._forked[-1]

    def ask(self, question: dict) -> int | None:
        with self._turn:
            self._process.stdin.write(json.dumps(question) + "\n")
            self._process.stdin.flush()
            return json.loads(self._process.stdout.readline())


@cache
def shared_fork_server(program: tuple[str, ...]) -> ForkServer:
    """Return the fork server of a program that all tests of this process use."""
    server = ForkServer(program, Path(tempfile.mkdtemp(prefix="fork-server-")))
    atexit.register(server.__exit__)
    return server


class Forked:
    """One program of a fork server, to be used like a `Popen`."""

    def __init__(self, server: ForkServer, pid: int, pipe: Path):
        self._server = server
        self.pid = pid
        self.returncode: int | None = None
        self.stdout = pipe.open(encoding="utf-8")
        self._reader: threading.Thread | None = None
        pipe.unlink()

    def next_line(self) -> str:
        """Return the next line that it prints; "" once it has ended."""
        return self.stdout.readline().strip()

    def drain_output(self) -> None:
        """Read its output from now on: with a full pipe it would wait for a reader."""
        self._reader = threading.Thread(target=self.stdout.read, daemon=True)
        self._reader.start()

    def poll(self) -> int | None:
        """Return its exit status, None while it runs."""
        if self.returncode is None:
            self.returncode = self._server.ask({"wait": self.pid})
        return self.returncode

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)

    def communicate(self, timeout: float | None = None) -> None:  # noqa: ARG002
        """Wait until it has ended, and read the rest of its output."""
        if self._reader is not None:
            self._reader.join()
        elif not self.stdout.closed:
            self.stdout.read()
        while self.poll() is None:
            time.sleep(LOOK_S)
        self.stdout.close()

    def end(self, number: int = signal.SIGKILL) -> int:
        """End it and return its exit status."""
        self.send_signal(number)
        self.communicate()
        return self.returncode
