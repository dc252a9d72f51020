"""Whether the interval of the expected TRE contains the true TRE, and its blind spots."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from rastrainer import transforms
from rastrainer.number_text import fixed
from rastrainer.registration.localization_error import stated_error
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM, target_error
from rastrainer_simulator.statistics.intervals import rms
from Testing.error_rates.measured import Measured, holds, share_of, share_text

HEADER = (
    "errors of the touches",
    "interval contains the true TRE",
    "without the common offset",
    "true TRE, RMS, mm",
    "expected TRE, RMS, mm",
)
COUNT, RADIUS_MM, FLE_MM = 15, 90.0, 1.0
Errors = Callable[[np.ndarray, np.random.Generator], np.ndarray]
"""Maps outward normals (n, 3) at the fiducials to errors of their touches, (n, 3), mm."""


def intervals(sets: int, seed: int = 10) -> list[Measured]:
    """Return how often the true TRE is in the interval, for random heads and targets.

    Fiducials are on one side of a ball, the target is inside; the localization error is 1 mm.
    """
    common = f"independent, equal, with a common offset of SD {COMMON_BIAS_SD_MM:g} mm on each axis"
    aside = "independent, but three times as large for a third of the fiducials, on one side"
    cases: list[tuple[str, Errors, float | None, int, bool]] = [
        ("independent, unbiased, equal", _alike, 0.94, 0, False),
        (aside, _unequal, None, 1, False),
        ("as in row 2, each point weighted by its known error", _unequal, 0.94, 1, True),
        (common, lambda n, r: _alike(n, r) + r.normal(0, COMMON_BIAS_SD_MM, 3), 0.94, 2, False),
        (
            "as in row 1, and all touches 2 mm above the skin",
            *(lambda n, r: _alike(n, r) + 2.0 * n, None, 3, False),
        ),
        (
            "as in row 1, and a constant aim bias of 1.5 mm",
            *(lambda n, r: _alike(n, r) + np.array([1.5, 0.0, 0.0]), None, 4, False),
        ),
    ]
    return [
        _measured(words, errors, limit, sets, np.random.default_rng([seed, stream]), is_weighted)
        for words, errors, limit, stream, is_weighted in cases
    ]


def _alike(normals: np.ndarray, random: np.random.Generator) -> np.ndarray:
    return random.normal(0, FLE_MM / np.sqrt(3), normals.shape)


def _unequal(normals: np.ndarray, random: np.random.Generator) -> np.ndarray:
    return localization_errors(normals)[:, None] / FLE_MM * _alike(normals, random)


def one_side(random: np.random.Generator) -> np.ndarray:
    """Return unit normals (n, 3) of a ball's surface on one side of it."""
    normals = random.normal(size=(COUNT, 3)) * 0.45 + [0.0, 1.0, 0.0]
    return normals / np.linalg.norm(normals, axis=1)[:, None]


def localization_errors(normals: np.ndarray) -> np.ndarray:
    """Return the localization errors of points, (n,) mm; a third is three times as large."""
    is_aside = normals[:, 0] > np.quantile(normals[:, 0], 2 / 3)
    return FLE_MM * np.where(is_aside, 3.0, 1.0)


def _measured(
    words: str,
    errors: Errors,
    at_least: float | None,
    sets: int,
    random: np.random.Generator,
    is_weighted: bool,
) -> Measured:
    inside, before, true, expected = [], [], [], []
    for _ in range(sets):
        normals = one_side(random)
        fiducials, target = RADIUS_MM * normals, random.normal(0, 20, 3)
        touches, known, weights = fiducials + errors(normals, random), None, None
        if is_weighted:
            fle_mm = localization_errors(normals)
            known, weights = stated_error(fle_mm), 1 / fle_mm**2
        registration = register(touches, fiducials, weights=weights)
        there = transforms.apply(registration.matrix, target[None])[0]
        true.append(float(np.linalg.norm(there - target)))
        widened = target_error(registration, target, known)
        without = target_error(registration, target, known, common_bias_sd_mm=0.0)
        inside.append(holds(widened.interval_mm, true[-1]))
        before.append(holds(without.interval_mm, true[-1]))
        expected.append(widened.expected_mm)
    further = share_text(share_of(before)), *(fixed(rms(each), 2) for each in (true, expected))
    return Measured(words, share_of(inside), sets, at_least=at_least, further=further)
