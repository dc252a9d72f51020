"""The simulator as its own process, as a user starts it, with views that a test can join."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path
from typing import Any

from rastrainer_simulator.net.limits import LIMITS_FILE
from Testing.without_tutorial import skip_tutorial

COMMAND = [sys.executable, "-m", "rastrainer_simulator.cli.main", "simulator"]
READY = "RASTrainer simulator ready on 127.0.0.1:"
GONE_S = 600


class SimulatorProcess:
    """`rastrainer simulator` on a free port; ended by the `with` statement.

    Attributes:
        ready: the line that says where it is ready.
        port: where it listens; 0 where it connects.
        pid: of the process.
        command: that starts it.
    """

    command = tuple(COMMAND)

    def __init__(self, records: Path, *arguments: str, **others: Any):
        config = records.with_name(records.name + "-config")
        skip_tutorial(config)
        _keep_views(config)
        settings = ["--port", "0", "--records", str(records), "--config", str(config)]
        # A pipe that no one reads would be full after some minutes.
        self._errors = tempfile.TemporaryFile("w+")  # noqa: SIM115
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
            self._process.wait()
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


def _keep_views(config: Path) -> None:
    """Let no view count as gone because a busy machine is slow, unless the limits say when."""
    path = config / LIMITS_FILE
    limits = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    views = {"goneS": GONE_S, **limits.get("views", {})}
    path.write_text(json.dumps({**limits, "views": views}), encoding="utf-8")


SERVES = re.compile(r"serves views on (http://\S+), pairing code (\d{6})$")
LINE = re.compile(
    r"RASTrainer simulator serves views on (http://127\.0\.0\.1:(\d+)), pairing code (\d{6})\n"
)


class ViewedSimulator(SimulatorProcess):
    """A simulator whose views a test can join.

    Attributes:
        url, view_port, code: as it prints them.
        key: of a view that was paired with the code.
    """

    def __init__(self, records: Path, *arguments: str):
        super().__init__(records, "--no-gamepad", *arguments)
        line = LINE.fullmatch(self._process.stdout.readline())
        self.url, self.view_port, self.code = line[1], int(line[2]), line[3]
        self.key = paired_key(self.url, self.code)


def paired_key(url: str, code: str) -> str:
    """Pair a view by its code, as its page does; return its key."""
    request = urllib.request.Request(f"{url}/pair", json.dumps({"code": code}).encode())
    with urllib.request.urlopen(request, timeout=60) as answer:
        return json.load(answer)["key"]
