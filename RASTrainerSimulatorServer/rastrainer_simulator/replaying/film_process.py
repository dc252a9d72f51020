"""The short-lived process that makes a film: it would keep the control loop from its ticks.

It reads one JSON object from standard input: `journal` (the file), `scenario` and `robotMeshes`
(folders, null for the meshes that come with RASTrainer). It writes pickles to standard output:
numbers from 0 to 1, the share of the work done, and at the end the `Film`.
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import sys
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.journal_reader import read_journal
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.replaying.film import Film, make_film


def main() -> int:
    """Make the film that is asked for; return 2, with one sentence, where that is impossible."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(10)  # The control loop of the parent comes first.
    wanted = json.load(sys.stdin)
    meshes = wanted["robotMeshes"]
    try:
        reading = read_journal(Path(wanted["journal"]))
        setup = setup_of(reading.header, Path(wanted["scenario"]), meshes and Path(meshes))
        _tell(make_film(reading, setup, _tell))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _tell(news: float | Film) -> None:
    pickle.dump(news, sys.stdout.buffer, pickle.HIGHEST_PROTOCOL)
    sys.stdout.buffer.flush()


if __name__ == "__main__":
    sys.exit(main())
