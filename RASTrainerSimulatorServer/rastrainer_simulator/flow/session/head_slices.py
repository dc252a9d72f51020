"""Three slices of a case's images: skin, registered points, residuals and a place, as lines."""

from __future__ import annotations

from collections.abc import Mapping
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
CONTOUR_POINTS, SPARED = 320, 80
"""Points of a drawn contour, and below how many of them each case goes without: of all heads alike,
so that the size of a message tells no head from another.
"""
SIDES = "RAS", "LPI"
"""Letters of the patient's sides along each axis, and against it."""
PLANES: Mapping[str, tuple[tuple[int, float], tuple[int, float]]] = {
    "sagittal": ((1, -1.0), (2, 1.0)),
    "coronal": ((0, -1.0), (2, 1.0)),
    "axial": ((0, -1.0), (1, 1.0)),
}
"""Right and up of each slice, as an axis of RAS and its sign, in the radiological convention; in
the order of the axes across which they cut."""


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
    residuals, errors = case.residuals_mm, case.registered_mm - case.fixed_mm
    longer = LONGER if residuals.max() <= LONGEST_MM else 1.0
    ends = np.stack([case.fixed_mm, case.fixed_mm + longer * errors], axis=1)
    marked = [
        *([(SliceMark.TRACE, case.trace_mm)] if len(case.trace_mm) else ()),
        *((SliceMark.RESIDUAL, both) for both in ends),
        (SliceMark.POINT, case.fixed_mm),
        *((mark, place[np.newaxis]) for mark, place in places.items()),
    ]
    slices = tuple(
        Slice(
            texts.say(f"slices.{plane}"),
            tuple(_side(axis, way * sign) for axis, sign in axes for way in (-1.0, 1.0)),
            tuple(
                _flat(mark, line - middle, axes)
                for mark, line in (*((SliceMark.SKIN, line) for line in lines), *marked)
            ),
        )
        for (plane, axes), lines in zip(PLANES.items(), drawn, strict=True)
    )
    marks = dict.fromkeys(line.mark for each in slices for line in each.lines)
    keys = {each: f"slices.{each.value}" for each in marks}
    if longer == 1.0:
        keys[SliceMark.RESIDUAL] = "match.residual"
    legend = tuple(SliceLegend(each, texts.say(keys[each], longer=longer)) for each in marks)
    main = np.abs(errors).argmax(axis=1)
    ways = texts.listed(
        texts.say("slices.residual of", label=label, residual=mm, side=_side(axis, error[axis]))
        for label, mm, axis, error in zip(case.labels, residuals, main, errors, strict=True)
    )
    return HeadSlices(texts.say("slices.text", name=name, ways=ways), slices, legend)


@lru_cache(maxsize=16)
def _contours(case: DecisionCase, place_mm: tuple[float, ...]) -> list[list[np.ndarray]]:
    """Return the skin cut through a place by each plane, with as few points as a picture needs."""
    kept, cuts = CONTOUR_POINTS - case.seed % SPARED, case.contours(np.array(place_mm))
    return [
        [line[np.linspace(0, len(line) - 1, kept).round().astype(int)] for line in lines]
        for lines in cuts
    ]


def _flat(
    mark: SliceMark, line: np.ndarray, axes: tuple[tuple[int, float], tuple[int, float]]
) -> SliceLine:
    right, up = (np.round(sign * line[:, axis], 1).tolist() for axis, sign in axes)
    return SliceLine(mark, tuple(zip(right, up, strict=True)))


def _side(axis: int, sign: float) -> str:
    return SIDES[int(sign < 0.0)][axis]
