"""The surface match compared with the ICP of VTK, Open3D and small_gicp, from the same starts.

`compared.csv` holds the comparisons, a row for each head, seed and peer. `python -m
Testing.icp_peers.compare SEEDS` adds the missing comparisons of so many seeds; it can be stopped at
any time. Open3D and small_gicp are in `.venv/icp` (`make soak` puts them there).
"""

from __future__ import annotations

import itertools
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_fit import fit_to_surface
from rastrainer.registration.surface_match import TOLERANCE_MM, match_surface
from Testing.domain.registration.traces import (
    coarse_start,
    colin27,
    error_at_center,
    head_pose,
    places,
    traced,
)
from Testing.error_rates.row_files import add_row, stored_rows
from Testing.icp_peers.vtk_icp import vtk_match
from Testing.simulator.authoring.heads import egg, small

FILE = Path(__file__).with_name("compared.csv")
PYTHON = Path(sys.prefix) / "icp" / "bin" / "python"
HEADS: dict[str, Callable[[], HeadMesh]] = {"colin27": colin27, "egg": egg, "small": small}
PEERS = ("vtk", "open3d", "small_gicp")
BATCH = 10
NOISE_MM, START_SD_MM, START_SD_DEG = 0.5, 5.0, 5.0
SAME_MM, WRONG_MM = 0.01, 3.0


@dataclass(frozen=True)
class Comparison:
    """One trace of 200 points on the face, registered by a peer and by us.

    The cost is the sum of the squared distances to the triangles; `cost_off_mm2` is the peer's
    minus ours, and `apart_mm` is how far its points are from ours at most. `next_…` are the same
    for the minimum next to where it stopped. The errors are at the head's center.
    """

    head: str
    seed: int
    peer: str
    cost_mm2: float
    cost_off_mm2: float
    apart_mm: float
    next_off_mm2: float
    next_apart_mm: float
    error_mm: float
    peer_error_mm: float
    warned: int


def compare(name: str, seeds: range) -> list[Comparison]:
    """Return one row for each seed and peer."""
    head = HEADS[name]()
    skin, rows = head.skin, places(head, "face")
    cases = []
    for seed in seeds:
        random = np.random.default_rng([seed, 7])
        pose = head_pose(random)
        trace = traced(head, rows, random, pose, NOISE_MM)
        cases.append((trace, coarse_start(random, pose, START_SD_MM, START_SD_DEG), pose))
    begun = np.array([transforms.apply(start, trace) for trace, start, _ in cases])
    moved = _others(skin, begun)
    found = []
    for row, (seed, (trace, start, pose)) in enumerate(zip(seeds, cases, strict=True)):
        match = match_surface(trace, head, start, seed=seed, trimmed=False)
        ours = float(np.sum(match.residuals_mm**2))
        for peer in PEERS:
            theirs = vtk_match(trace, skin, start) if peer == "vtk" else moved[peer][row] @ start
            nearby = fit_to_surface(trace, skin, theirs[None], TOLERANCE_MM, gate_mm=np.inf)
            cost = np.sum(skin.tree.nearest(transforms.apply(theirs, trace)).distances ** 2)
            numbers = (
                *(ours, float(cost) - ours, _apart(theirs, match.matrix, trace)),
                float(np.sum(nearby.distances_mm**2)) - ours,
                _apart(nearby.matrices[0], match.matrix, trace),
                *(error_at_center(matrix, pose, head) for matrix in (match.matrix, theirs)),
            )
            rounded = (float(f"{number:.6g}") for number in numbers)
            found.append(Comparison(name, seed, peer, *rounded, int(bool(match.warnings))))
    return found


def _others(skin: HeadMesh, traces: np.ndarray) -> dict[str, np.ndarray]:
    """Return how Open3D and small_gicp move traces (k, n, 3), (k, 4, 4) float for each."""
    with tempfile.TemporaryDirectory() as folder:
        cases, results = Path(folder) / "cases.npz", Path(folder) / "results.npz"
        np.savez(cases, vertices=skin.vertices, triangles=skin.triangles, traces=traces)
        script = Path(__file__).with_name("others.py")
        subprocess.run([PYTHON, script, cases, results], check=True)
        with np.load(results) as found:
            return {peer: found[peer] for peer in found.files}


def _apart(one: np.ndarray, other: np.ndarray, trace: np.ndarray) -> float:
    apart = transforms.apply(one, trace) - transforms.apply(other, trace)
    return float(np.linalg.norm(apart, axis=1).max())


def stored() -> list[Comparison]:
    return stored_rows(FILE, Comparison)


def table() -> str:
    """Return the table of `comparison.md`."""
    lines = [
        "| head | peer | starts | stopped lower than ours | stopped within 0.01 mm of ours "
        "| the minimum next to it is ours | that one is lower | and by at most, mm² "
        "| more than 3 mm off: peer, ours |",
        "|" + " --- |" * 9,
    ]
    known = stored()
    for head in HEADS:
        for peer in PEERS:
            own = [one for one in known if (one.head, one.peer) == (head, peer)]
            lower = [-one.next_off_mm2 for one in own if one.next_off_mm2 < -LOWER_MM2]
            cells = (
                head,
                peer,
                len(own),
                sum(one.cost_off_mm2 < -LOWER_MM2 for one in own),
                sum(one.apart_mm < SAME_MM for one in own),
                sum(one.next_apart_mm < SAME_MM for one in own),
                len(lower),
                f"{max(lower, default=0.0):.4f}",
                f"{sum(one.peer_error_mm > WRONG_MM for one in own)}, "
                f"{sum(one.error_mm > WRONG_MM for one in own)}",
            )
            lines.append("| " + " | ".join(map(str, cells)) + " |")
    return "\n".join(lines)


LOWER_MM2 = 1e-4
"""The cost is some 50 mm²; a smaller difference comes from a fit's tolerance."""


def compare_missing(seeds: int) -> None:
    """Compare what the file lacks, and add each batch to it at once."""
    known = {(one.head, one.seed) for one in stored()}
    for first, head in itertools.product(range(0, seeds, BATCH), HEADS):
        if (head, first) not in known:
            for row in compare(head, range(first, first + BATCH)):
                add_row(FILE, row)
            print(head, first, flush=True)


if __name__ == "__main__":
    compare_missing(int(sys.argv[1]))
