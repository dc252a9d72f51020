"""The simulator as its own process, as a user starts it, with views that a test can join."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rastrainer_simulator.net.limits import LIMITS_FILE
from Testing.end_to_end.fork_server import SIMULATOR, shared_fork_server
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient
from Testing.without_tutorial import skip_tutorial

COMMAND = [sys.executable, "-m", "rastrainer_simulator.cli.main", "simulator"]
READY = "RASTrainer simulator ready on 127.0.0.1:"
GONE_S = 600


class SimulatorProcess:
    """`rastrainer simulator` on a free port; ended by the `with` statement.

    It is forked, which is quicker than a start, unless it has another command.

    Attributes:
        ready: the line that says where it is ready.
        port: where it listens; 0 if it connects.
        pid: of the process.
        command: that starts it.
        is_forked: whether it may be forked.
        first: Python code to run in a forked simulator at first.
    """

    command = tuple(COMMAND)
    is_forked = hasattr(os, "fork")
    first = ""

    def __init__(self, records: Path, *arguments: str, **others: Any):
        config = records.with_name(records.name + "-config")
        skip_tutorial(config)
        _keep_views(config)
        settings = ["--port", "0", "--records", str(records), "--config", str(config)]
        # A pipe that no one reads would be full after some minutes.
        self._errors = tempfile.NamedTemporaryFile("w+")  # noqa: SIM115
        if self.is_forked and self.command == tuple(COMMAND) and set(others) <= {"env"}:
            words = ("simulator", *settings, *arguments)
            server = shared_fork_server(SIMULATOR)
            how = {"errors": self._errors.name, "first": self.first, **others}
            self._process = server.fork(*words, **how)
        else:
            self._process = subprocess.Popen(
                [*self.command, *settings, *arguments],
                stdout=subprocess.PIPE,
                stderr=self._errors,
                text=True,
                **others,
            )
        self.pid = self._process.pid
        self.ready = self.next_line()
        if not self.ready:
            self._process.communicate()
            raise AssertionError(self._captured_output())
        self.port = int(self.ready.removeprefix(READY)) if self.ready.startswith(READY) else 0

    def __enter__(self) -> SimulatorProcess:
        return self

    def __exit__(self, *_exception: object) -> None:
        if self._process.poll() is None:
            self.kill()

    def next_line(self) -> str:
        """Return the next line that it prints; "" once it has ended."""
        return self._process.stdout.readline().strip()

    def stop(self, number: int = signal.SIGTERM) -> tuple[int, str]:
        """Ask it to stop; return its exit status and its stderr."""
        self._process.send_signal(number)
        return self.wait()

    def kill(self) -> None:
        """End it as a crash would."""
        self._process.kill()
        self._process.communicate()

    def wait(self) -> tuple[int, str]:
        """Wait until it has ended by itself; return its exit status and its stderr."""
        self._process.communicate(timeout=300)
        return self._process.returncode, self._captured_output()

    def _captured_output(self) -> str:
        self._errors.seek(0)
        return self._errors.read()


class StartedSimulator(SimulatorProcess):
    """A simulator that has imported nothing before it starts, to be measured."""

    is_forked = False


def _keep_views(config: Path) -> None:
    """Let no view count as gone because a busy machine is slow, unless the limits say when."""
    path = config / LIMITS_FILE
    limits = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    views = {"goneS": GONE_S, **limits.get("views", {})}
    path.write_text(json.dumps({**limits, "views": views}), encoding="utf-8")


SERVES = re.compile(r"serves views on (http://\S+), pairing code (\d{6})$")


class ViewedSimulator(SimulatorProcess):
    """A simulator whose views a test can join.

    Attributes:
        url, view_port, code: as it prints them.
        key: of a view that was paired with the code.
    """

    def __init__(self, records: Path, *arguments: str):
        super().__init__(records, "--no-gamepad", *arguments)
        self.url, self.code = SERVES.search(self.next_line()).groups()
        self.view_port = int(self.url.rpartition(":")[2])
        self.key = paired_key(self.url, self.code)


class MenuView(ViewClient):
    """A view in which somebody clicks through menus, which are read as JSON.

    Attributes:
        received: all messages so far, as they came.
    """

    def __init__(self, thread: LoopThread, simulator: ViewedSimulator, role: str = "view"):
        key = paired_key(simulator.url, simulator.code, role)
        super().__init__(thread, simulator.url, key)
        self.received: list[str] = []
        self.join(kind="page" if role == "view" else role)

    def next_text(self) -> str:
        self.received.append(super().next_text())
        return self.received[-1]

    def until(self, is_wanted: Callable[[dict], bool]) -> dict:
        """Return the next screen that meets a condition."""
        while not is_wanted(screen := self.next("screen")["screen"]):
            pass
        return screen

    def until_menu(self, name: str, is_wanted: Callable[[dict], bool] = bool) -> dict:
        """Return the next open menu of that name that meets a condition."""
        screen = self.until(
            lambda screen: (menu := screen.get("menu")) and menu["name"] == name and is_wanted(menu)
        )
        return screen["menu"]

    def go(self, item: str, menu: str) -> dict:
        """Choose an item, and return the menu to which it leads."""
        self.send({"type": "item", "name": item})
        return self.until_menu(menu)

    def type(self, name: str, value: str) -> None:
        self.send({"type": "text", "name": name, "value": value})

    def go_to_experiment(self, trainee: str) -> None:
        """Go from the start to the menu of tasks, and enter an ID."""
        self.go("train", "introduction")
        self.go("skip", "controls")
        self.go("next", "experiment")
        self.type("trainee", trainee)


def items_of(menu: dict) -> dict[str, dict]:
    return {item["name"]: item for item in menu["items"]}


def paired_key(url: str, code: str, role: str = "view") -> str:
    """Pair a view by its code, as its page does; return its key."""
    body = json.dumps({"code": code, "role": role}).encode()
    request = urllib.request.Request(f"{url}/pair", body)
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)["key"]
