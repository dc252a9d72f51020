"""Slicer's side with a study, as a process: the module's whole session, without its panels."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rastrainer.protocol import DEFAULT_HOST
from rastrainer.study.database.database import PostgresAddress, study_place
from rastrainer_headless.main import openSession, process
from rastrainer_headless.scene import HeadlessScene
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.fork_server import STUDY_SIDE, shared_fork_server

ROOT = Path(__file__).parents[2]
STUDY, RECORDS = "study.db", "records"
PERIOD_S = 0.05


def run(folder: Path, port: int, address: str = "") -> None:
    """Lead the trainees of the study in a folder, or at an address. Never returns.

    No trainee is chosen.
    """
    place = study_place(address) if address else None
    place = place if isinstance(place, PostgresAddress) else None
    session = openSession(HeadlessScene(), folder, asset_path(), place)
    session.link.connectTo(DEFAULT_HOST, port)
    while True:
        process(session)
        time.sleep(PERIOD_S)


class StudySide:
    """Runs it; killed by the `with` statement as by a crash."""

    def __init__(self, folder: Path, port: int):
        self._process = shared_fork_server(STUDY_SIDE).fork(str(folder), str(port))

    def __enter__(self) -> StudySide:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.kill()

    def kill(self) -> None:
        """End it as a crash would."""
        self._process.end()


def main(arguments: Sequence[str]) -> None:
    """Run with folder, port and perhaps the study's address."""
    folder, port, *address = arguments
    run(Path(folder), int(port), *address)


if __name__ == "__main__":
    main(sys.argv[1:])
