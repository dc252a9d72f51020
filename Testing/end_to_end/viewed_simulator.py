"""The simulator as its own process, with views that a test can join."""

from __future__ import annotations

import os
import re
from pathlib import Path

from Testing.end_to_end.simulator_process import SimulatorProcess

LINE = re.compile(
    r"RASTrainer simulator serves views on (http://127\.0\.0\.1:(\d+)), pairing code (\d{6})\n"
)


class ViewedSimulator(SimulatorProcess):
    """A simulator whose views a test can join.

    Attributes:
        url, view_port, code: as it prints them.
    """

    def __init__(self, records: Path, *arguments: str, key: str | None = None):
        environment = dict(os.environ)
        if key is not None:
            environment["RASTRAINER_VIEW_KEY"] = key
        super().__init__(records, "--no-gamepad", *arguments, env=environment)
        line = LINE.fullmatch(self._process.stdout.readline())
        self.url, self.view_port, self.code = line[1], int(line[2]), line[3]
