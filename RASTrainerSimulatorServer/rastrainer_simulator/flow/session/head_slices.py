"""Three slices of a case's images: skin, registered points, residuals and a place, as lines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from rastrainer_simulator.presentation.screen import (
    HeadSlices,
    Slice,
    SliceLegend,
    SliceLine,
    SliceMark,
)
from rastrainer_simulator.texts.texts import Texts

if TYPE_CHECKING:
    from rastrainer_simulator.decision.cases import DecisionCase

LONGER, LONGEST_MM = 5.0, 8.0
"""Factor by which residuals are drawn longer, unless one exceeds the second number."""
SPACING_MM = 1.5
"""Distance between the points of a drawn contour."""
SIDES = "RAS", "LPI"
"""Letters of the patient's sides along each axis, and against it."""
PLANES: Mapping[str, tuple[tuple[int, float], tuple[int, float]]] = {
    "sagittal": ((1, -1.0), (2, 1.0)),
    "coronal": ((0, -1.0), (2, 1.0)),
    "axial": ((0, -1.0), (1, 1.0)),
}
"""Right and up of each slice, as an axis of RAS and its sign, in the radiological convention; in
the order of the axes across which they cut."""


def drawn_longer(case: DecisionCase) -> float:
    """Return the factor by which the residuals are drawn longer."""
    return LONGER if max(case.residuals_mm, default=0.0) <= LONGEST_MM else 1.0


def head_slices(
    texts: Texts,
    case: DecisionCase,
    through_mm: np.ndarray,
    places: Mapping[SliceMark, np.ndarray],
    name: str,
) -> HeadSlices:
    """Return the slices through a place, called `name`, with other places marked; RAS, mm."""
    drawn = _contours(case, tuple(np.round(through_mm, 3).tolist()))
    everything = np.concatenate([*(line for lines in drawn for line in lines), case.fixed_mm])
    middle = (everything.min(axis=0) + everything.max(axis=0)) / 2.0
    slices = tuple(
        Slice(
            texts.say(f"slices.{plane}"),
            tuple(_side(axis, way * sign) for axis, sign in axes for way in (-1.0, 1.0)),
            tuple(_flat(mark, line - middle, axes) for mark, line in _lines(case, lines, places)),
        )
        for (plane, axes), lines in zip(PLANES.items(), drawn, strict=True)
    )
    marks = dict.fromkeys(line.mark for each in slices for line in each.lines)
    longer = drawn_longer(case)
    keys = {each: f"slices.{each.value}" for each in marks}
    if longer == 1.0:
        keys |= {SliceMark.RESIDUAL: "match.residual"}
    legend = tuple(SliceLegend(each, texts.say(keys[each], longer=longer)) for each in marks)
    return HeadSlices(texts.say("slices.text", name=name, ways=_ways(texts, case)), slices, legend)


@lru_cache(maxsize=16)
def _contours(case: DecisionCase, place_mm: tuple[float, ...]) -> list[list[np.ndarray]]:
    """Return the skin cut through a place by each plane, with as few points as a picture needs."""
    return [[_thinned(line) for line in lines] for lines in case.contours(np.array(place_mm))]


def _thinned(line: np.ndarray) -> np.ndarray:
    steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
    number = np.floor(np.concatenate([[0.0], np.cumsum(steps)]) / SPACING_MM)
    kept = np.concatenate([[True], np.diff(number) > 0])
    kept[-1] = True
    return np.asarray(line[kept])


def _lines(
    case: DecisionCase, skin: list[np.ndarray], places: Mapping[SliceMark, np.ndarray]
) -> Iterator[tuple[SliceMark, np.ndarray]]:
    for line in skin:
        yield SliceMark.SKIN, line
    if len(case.trace_mm):
        yield SliceMark.TRACE, case.trace_mm
    for fixed, registered in zip(case.fixed_mm, case.registered_mm, strict=True):
        end = fixed + drawn_longer(case) * (registered - fixed)
        yield SliceMark.RESIDUAL, np.array([fixed, end])
    if len(case.fixed_mm):
        yield SliceMark.POINT, case.fixed_mm
    for mark, place in places.items():
        yield mark, place[np.newaxis]


def _flat(
    mark: SliceMark, line: np.ndarray, axes: tuple[tuple[int, float], tuple[int, float]]
) -> SliceLine:
    right, up = (np.round(sign * line[:, axis], 1).tolist() for axis, sign in axes)
    return SliceLine(mark, tuple(zip(right, up, strict=True)))


def _side(axis: int, sign: float) -> str:
    return SIDES[int(sign < 0.0)][axis]


def _ways(texts: Texts, case: DecisionCase) -> str:
    """Return the residuals in words: of each point its length and its main direction."""
    errors = case.registered_mm - case.fixed_mm
    main = np.abs(errors).argmax(axis=1)
    return texts.listed(
        texts.say(
            "slices.residual of",
            label=label,
            residual=residual,
            side=_side(axis, error[axis]),
        )
        for label, residual, axis, error in zip(
            case.labels, case.residuals_mm, main, errors, strict=True
        )
    )
