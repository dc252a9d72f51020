"""Making scenarios of volumes: the head of a phantom, and whole scenarios of real heads."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from rastrainer.slicer.head.head_draft import makeDraft
from Testing.benchmarks.row import row
from Testing.slicer.head.debian_heads import COLIN27, CT_PROJECT, write_ct
from Testing.slicer.head.phantoms import phantom

BUILD = [sys.executable, "-m", "rastrainer_simulator.cli.main", "scenario", "build"]


def rows(quick: bool) -> list[dict]:
    """Return the row `scenario.head`: the skin of a phantom of 1 mm, without the skull."""
    volume, seconds = phantom(), []
    for _ in range(1 if quick else 3):
        began = time.perf_counter()
        makeDraft(volume, hasSkull=False)
        seconds.append(time.perf_counter() - began)
    return [row("scenario.head", seconds, "s")]


def long_rows() -> list[dict]:
    """Return the rows `scenario.build.mri` and `.ct`: `rastrainer scenario build`, all of it.

    The heads come from Debian's `mricron-data` and `invesalius-examples`; a missing head has no
    row.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder, timed = Path(temporary), []
        if COLIN27.is_file():
            timed.append(_build("mri", COLIN27, folder))
        if CT_PROJECT.is_file():
            timed.append(_build("ct", write_ct(folder / "ct.nrrd"), folder))
        return timed


def _build(name: str, volume: Path, folder: Path) -> dict:
    began = time.perf_counter()
    built = subprocess.run(
        [*BUILD, str(volume), "-o", str(folder / name)], stdout=subprocess.DEVNULL, check=False
    )
    seconds = time.perf_counter() - began
    return row(f"scenario.build.{name}", [seconds], "s", success=float(built.returncode == 0))
