"""The warnings of a surface match: how often they are false, and how often they are missing.

`match_warnings.csv` has the matched traces, five a row. `python -m
Testing.error_rates.match_warnings` adds the missing rows of `CHUNKS` for each head and case,
all cases in turn. It can be stopped at any time: the table says how many traces there were.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.random import Generator

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.trial_head import SkinShift
from rastrainer.registration.surface_checks import SLIDE_LIMIT_MM, SurfaceMatch, places_around
from rastrainer.registration.surface_match import match_surface
from Testing.domain.registration.traces import coarse_start, head_pose, places, random_walk
from Testing.error_rates.measured import Measured, share_text
from Testing.error_rates.row_files import play_missing, stored_rows
from Testing.simulator.authoring import heads

FILE = Path(__file__).with_name("match_warnings.csv")
HEADER = (
    "trace, points, and shift of the skin",
    "warned although near",
    "off by more than 3.5 mm",
    "of these not named",
    "refused",
    "traces",
)
HEADS: dict[str, Callable[[], HeadMesh]] = {
    "colin27": heads.colin27,
    "deformed": heads.deformed,
    "small": heads.small,
}
NOISE_MM, DAB_MM = 0.5, 22.0
CHUNK, CHUNKS, FIRST_SEED = 5, 20, 1000
MOST_FALSE, LEAST_GOOD = 0.05, 100
FIRST_HEAD = "colin27"
GOOD, NARROW = ("whole face", "drawn at random"), ("one side", "crown", "one place")
FEW_FAR = "one place, and 1 in 20 points anywhere"
CASES = (
    *((GOOD[0], points, shift) for points in (30, 100, 200, 500) for shift in (0.0, 2.0)),
    *((GOOD[1], points, 0.0) for points in (100, 300, 500)),
    *((where, points, 0.0) for where in (*NARROW, FEW_FAR) for points in (30, 100, 300)),
)


@dataclass(frozen=True)
class Chunk:
    """Some traces of one case on one head.

    The counts are of traces: not matched, with a message; with a target that is off by more than
    3.5 mm, and of these with any warning; not off, but called sliding or with any warning.
    """

    head: str
    where: str
    points: int
    shift_mm: float
    chunk: int
    traces: int
    refused: int
    off: int
    off_named: int
    near_slides: int
    near_named: int


@functools.cache
def head_of(name: str) -> HeadMesh:
    """Return one of the heads."""
    return HEADS[name]()


@functools.cache
def rows_of(name: str, where: str) -> np.ndarray:
    """Return the vertices of a region of one of the heads."""
    return places(head_of(name), where)


def vertices(name: str, where: str, points: int, random: Generator) -> np.ndarray:
    """Return the vertices over which a trace goes, (points,) int."""
    head, face = head_of(name), rows_of(name, "face")
    if where == GOOD[1]:
        allowed = np.zeros(len(head.vertices), dtype=bool)
        allowed[face] = True
        return random_walk(head, allowed, random, points)
    if where in ("one place", FEW_FAR):
        away = np.linalg.norm(head.vertices[face] - head.vertices[random.choice(face)], axis=1)
        far = max(points // 20, 2) if where == FEW_FAR else 0
        near = random.choice(face[away < DAB_MM], points - far)
        return np.concatenate([near, random.choice(face, far)])
    region = {"whole face": "face", "one side": "side", "crown": "crown"}[where]
    return random.choice(rows_of(name, region), points)


def matched(
    name: str, where: str, points: int, shift_mm: float, seed: int
) -> tuple[SurfaceMatch, float]:
    """Return the match of a trace, and how far it is off at most at seven targets, mm."""
    head, random = head_of(name), np.random.default_rng([seed, points, int(shift_mm)])
    pose = head_pose(random)
    rows = vertices(name, where, points, random)
    skin = head.vertices[rows]
    drawn = skin + random.normal(0.0, NOISE_MM, (points, 1)) * head.vertex_normals[rows]
    drawn = drawn + SkinShift(shift_mm, seed).moved(skin, head)
    trace = transforms.apply(pose, drawn)
    match = match_surface(trace, head, coarse_start(random, pose, 2.0, 2.0), starts=1)
    targets = places_around(head.middle)
    off = transforms.apply(match.matrix @ pose, targets) - targets
    return match, float(np.linalg.norm(off, axis=1).max())


def play(
    name: str, where: str, points: int, shift_mm: float, chunk: int, traces: int = CHUNK
) -> Chunk:
    """Match the traces of a chunk, or the first of them."""
    counts = dict.fromkeys(("refused", "off", "off_named", "near_slides", "near_named"), 0)
    for seed in range(FIRST_SEED + CHUNK * chunk, FIRST_SEED + CHUNK * chunk + traces):
        try:
            match, off_mm = matched(name, where, points, shift_mm, seed)
        except InputError:
            counts["refused"] += 1
            continue
        is_off = off_mm > SLIDE_LIMIT_MM
        counts["off"] += is_off
        counts["off_named" if is_off else "near_named"] += bool(match.warnings)
        slides = any(warning.code == "slides" for warning in match.warnings)
        counts["near_slides"] += slides and not is_off
    return Chunk(name, where, points, shift_mm, chunk, traces, **counts)


def keys(chunks: int) -> Iterator[tuple[str, str, int, float, int]]:
    """Yield head, trace, number of points, shift and chunk of several chunks for each case."""
    for chunk, case, name in itertools.product(range(chunks), CASES, HEADS):
        yield (name, *case, chunk)


def measured(traces: int) -> list[Measured]:
    """Return the table: of what the file holds if many are asked for, else of new traces."""
    chunks = (
        stored_rows(FILE, Chunk)
        if traces > CHUNK
        else [play(*key, traces) for key in keys(1) if key[0] == FIRST_HEAD]
    )
    rows = []
    for where, points, shift in CASES:
        own = [c for c in chunks if (c.where, c.points, c.shift_mm) == (where, points, shift)]
        count, refused, off, named, slides = (
            sum(getattr(one, of) for one in own)
            for of in ("traces", "refused", "off", "off_named", "near_slides")
        )
        near = count - refused - off
        is_good = where == GOOD[0] and points >= LEAST_GOOD and not shift
        rows.append(
            Measured(
                f"{where}, {points}{f', {shift:g} mm' if shift else ''}",
                slides / near if near else 0.0,
                max(near, 1),
                at_most=MOST_FALSE if is_good else None,
                further=(
                    share_text(off / max(count - refused, 1)),
                    f"{off - named} of {off}",
                    str(refused),
                    str(count),
                ),
            )
        )
    return rows


if __name__ == "__main__":
    play_missing(FILE, Chunk, keys(CHUNKS), play, names=5)
