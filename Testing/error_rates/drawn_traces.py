"""Surface matches of traces as people draw them: are interval and warning right?

The points of a drawn trace are neighbors, so a hundred cover only a few places of the face.
`drawn_traces.csv` has the matched traces, one a row. `python -m
Testing.error_rates.drawn_traces` matches the missing traces of `SEEDS` for each head and case,
all cases in turn. It can be stopped at any time: the table says how many traces there were.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, outward_normals
from rastrainer.head.trial_head import SkinShift
from rastrainer.number_text import fixed
from rastrainer.registration import surface_error
from rastrainer.registration.surface_checks import SLIDE_LIMIT_MM, places_around
from rastrainer.registration.surface_match import match_surface
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM
from rastrainer_simulator.statistics.intervals import rms
from Testing.domain.registration.drawing_hands import EYE, draw_by_guidance, draw_in_strokes
from Testing.domain.registration.traces import coarse_start, head_pose
from Testing.error_rates.match_warnings import (
    FIRST_HEAD,
    HEADS,
    NOISE_MM,
    head_of,
    rows_of,
)
from Testing.error_rates.measured import Measured, holds, share_of, share_text
from Testing.error_rates.row_files import play_missing, stored_rows

HEADER = (
    "trace, points, and shift of the skin",
    "interval holds the true TRE",
    "expected TRE, RMS, mm",
    "true TRE, RMS, mm",
    "called sliding",
    "off by more than 3.5 mm",
    "off by no more than is said",
    "traces",
)
FILE = Path(__file__).with_name("drawn_traces.csv")
SEEDS = 100
REFUSED = "refused"
GUIDED, STROKES = "by guidance", "in strokes"
CASES = (
    *itertools.product((GUIDED,), (100,), (0.0, 2.0)),
    *itertools.product((STROKES,), (100, 200), (0.0, 2.0)),
    (STROKES, 400, 0.0),
)
LEAST_HELD, ENOUGH = 0.9, 400
"""Required of so many points, on skin at rest."""


@dataclass(frozen=True)
class Drawn:
    """The match of a trace; lengths are in mm.

    The error at the middle of the head, its expectation, and whether the interval contains it; the
    largest error among seven targets, and how far the match may slide. Warnings are codes with
    spaces between them; if the trace was `refused`, all results are 0.
    """

    head: str
    how: str
    points: int
    shift_mm: float
    seed: int
    error_mm: float
    expected_mm: float
    holds: int
    farthest_mm: float
    slide_mm: float
    warnings: str


def play(name: str, how: str, points: int, shift_mm: float, seed: int) -> Drawn:
    """Draw and match a trace, on a head in a random pose, as the program does.

    Traces of one seed on different heads have the same pose and the same offset of the tip.
    """
    head, random = head_of(name), np.random.default_rng([seed, points, int(shift_mm)])
    pose, tip = head_pose(random), random.normal(0.0, COMMON_BIAS_SD_MM, 3)
    skin = _drawn(head, name, how, points, random)
    noise = random.normal(0.0, NOISE_MM, (points, 1)) * outward_normals(head, skin)
    trace = transforms.apply(pose, skin + noise + SkinShift(shift_mm, seed).moved(skin, head) + tip)
    try:
        match = match_surface(trace, head, coarse_start(random, pose, 2.0, 2.0))
    except InputError:
        return Drawn(name, how, points, shift_mm, seed, 0.0, 0.0, 0, 0.0, 0.0, REFUSED)
    targets = places_around(head.middle)
    off = np.linalg.norm(transforms.apply(match.matrix @ pose, targets) - targets, axis=1)
    error = surface_error.surface_target_error(surface_error.knowledge_of(match), targets[0])
    return Drawn(
        *(name, how, points, shift_mm, seed),
        *(
            round(float(off[0]), 4),
            round(error.expected_mm, 4),
            int(holds(error.interval_mm, off[0])),
        ),
        *(round(float(off.max()), 4), round(match.slide.distance_mm, 4)),
        " ".join(warning.code for warning in match.warnings),
    )


def _drawn(
    head: HeadMesh, name: str, how: str, points: int, random: np.random.Generator
) -> np.ndarray:
    if how == STROKES:
        return draw_in_strokes(head, rows_of(name, "face"), random, points)
    guide = surface_error.TraceGuide(head, head.middle, EYE)
    return draw_by_guidance(head, guide, int(random.integers(2**31)), points)


def measured(traces: int) -> list[Measured]:
    """Return the table, from the file if so many traces are wanted, else played anew."""
    if traces >= SEEDS:
        drawn = stored_rows(FILE, Drawn)
    else:
        drawn = [play(FIRST_HEAD, *case, seed) for case in CASES for seed in range(traces)]
    rows = []
    for how, points, shift in CASES:
        own = [one for one in drawn if (one.how, one.points, one.shift_mm) == (how, points, shift)]
        matched = [one for one in own if one.warnings != REFUSED]
        is_off = [one.farthest_mm > SLIDE_LIMIT_MM for one in matched]
        further = (
            fixed(rms([one.expected_mm for one in matched]), 2),
            fixed(rms([one.error_mm for one in matched]), 2),
            *(
                share_text(share_of([one.slide_mm > SLIDE_LIMIT_MM for one in matched])),
                share_text(share_of(is_off)),
            ),
            share_text(share_of([one.farthest_mm <= one.slide_mm for one in matched])),
            str(len(own)),
        )
        is_asked = points >= ENOUGH and not shift
        rows.append(
            Measured(
                f"{how}, {points}{f', {shift:g} mm' if shift else ''}",
                share_of([bool(one.holds) for one in matched]),
                len(matched),
                at_least=LEAST_HELD if is_asked else None,
                further=further,
            )
        )
    return rows


def keys(seeds: int) -> Iterator[tuple[str, str, int, float, int]]:
    """Yield the key of each trace: head, way of drawing, points, shift and seed."""
    for seed in range(seeds):
        for case, head in itertools.product(CASES, HEADS):
            yield (head, *case, seed)


if __name__ == "__main__":
    play_missing(FILE, Drawn, keys(SEEDS), play, names=5)
