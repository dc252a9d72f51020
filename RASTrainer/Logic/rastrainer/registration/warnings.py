"""Warnings about points that can be registered but look wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.registration.checks import extents
from rastrainer.registration.faults import (
    find_bad_touches,
    find_order,
    find_scale,
    is_mirrored,
    is_poor_fit,
    mirrored,
    rigid_fre,
)
from rastrainer.registration.fits import AFFINE, RIGID, fit
from rastrainer.transforms import MM_PER_M

SAME_PLACE = 1e-3
"""Points nearer than this part of the set's extent count as one place (0.1 mm on a head)."""
NEARLY_FLAT = 0.05
UNITS = {MM_PER_M: "meters", 10.0: "centimeters", 25.4: "inches"}


@dataclass(frozen=True)
class RegistrationWarning:
    """Something that looks wrong with the points of a registration.

    Attributes:
        code: `nearly-collinear`, `nearly-coplanar`, `duplicate`, `scale`, `mirrored`, `order`,
            `outlier` or `poor-fit`.
        points: Labels of the points it is about.
        message: One sentence for the user, with the remedy.
    """

    code: str
    points: tuple[str, ...]
    message: str

    def to_json(self) -> dict[str, Any]:
        """Return the warning as a JSON object."""
        return {"code": self.code, "points": list(self.points), "message": self.message}


def find_warnings(
    moving: np.ndarray, fixed: np.ndarray, kind: str, labels: tuple[str, ...]
) -> tuple[RegistrationWarning, ...]:
    """Return warnings about points that passed `check_points`.

    Except for flatness they are based on rigid fits, since a similarity fit hides a wrong scale and
    an affine one a mirror. Each detected fault is corrected before searching for the next.
    """
    warnings: list[RegistrationWarning] = []
    for which, points in (("moving", moving), ("fixed", fixed)):
        warnings += _flat(points, which, kind, labels)
        warnings += _duplicates(points, which, labels)
    scale = find_scale(moving, fixed)
    if scale is not None:
        warnings.append(_scale(scale, labels))
        # The larger set is taken to be in mm, so that later sentences give true distances.
        moving, fixed = moving * max(scale, 1.0), fixed / min(scale, 1.0)
    if is_mirrored(moving, fixed):
        warnings.append(_mirrored(moving, fixed, labels))
        moving = mirrored(moving)
    order = find_order(moving, fixed)
    if order is not None:
        warnings.append(_order(moving, fixed, order, labels))
        moving = moving[order]
    bad = find_bad_touches(moving, fixed)
    warnings += _outliers(moving, fixed, bad, labels)
    warnings += _poor_fit(np.delete(moving, bad, axis=0), np.delete(fixed, bad, axis=0), labels)
    return tuple(warnings)


def _flat(
    points: np.ndarray, which: str, kind: str, labels: tuple[str, ...]
) -> list[RegistrationWarning]:
    along, across, out_of_plane = extents(points)
    if across < NEARLY_FLAT * along:
        message = (
            f"The {which} points ({', '.join(labels)}) lie nearly on one line, so the rotation "
            "about it is uncertain; add a point well away from it."
        )
        return [RegistrationWarning("nearly-collinear", labels, message)]
    if kind == AFFINE and out_of_plane < NEARLY_FLAT * along:
        message = (
            f"The {which} points ({', '.join(labels)}) lie nearly in one plane, so the affine "
            "registration is uncertain across it; add a point well away from it or choose rigid."
        )
        return [RegistrationWarning("nearly-coplanar", labels, message)]
    return []


def _duplicates(
    points: np.ndarray, which: str, labels: tuple[str, ...]
) -> list[RegistrationWarning]:
    limit = SAME_PLACE * np.linalg.norm(extents(points))
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    near = (distances <= limit) & ~np.eye(len(points), dtype=bool)
    twins = tuple(label for label, row in zip(labels, near, strict=True) if row.any())
    if not twins:
        return []
    message = (
        f"Points {_listed(twins)} of the {which} points are at the same place as another of them; "
        "touch or place each fiducial once."
    )
    return [RegistrationWarning("duplicate", twins, message)]


def _scale(scale: float, labels: tuple[str, ...]) -> RegistrationWarning:
    message = (
        f"The fixed points ({', '.join(labels)}) are {scale:.4g} times as far apart as the moving "
        f"points; {_unit_advice(scale)}."
    )
    return RegistrationWarning("scale", labels, message)


def _unit_advice(scale: float) -> str:
    for factor, unit in UNITS.items():
        if abs(scale / factor - 1) < 0.05:
            return f"the moving points seem to be in {unit}, they must be in millimeters"
        if abs(scale * factor - 1) < 0.05:
            return f"the fixed points seem to be in {unit}, they must be in millimeters"
    return "check that both are in millimeters and of the same head"


def _mirrored(
    moving: np.ndarray, fixed: np.ndarray, labels: tuple[str, ...]
) -> RegistrationWarning:
    message = (
        f"The moving points ({', '.join(labels)}) are a mirror image of the fixed points (rigid "
        f"FRE {rigid_fre(moving, fixed):.1f} mm, mirrored {rigid_fre(mirrored(moving), fixed):.1f} "
        "mm); check the sign of each axis and the coordinate system."
    )
    return RegistrationWarning("mirrored", labels, message)


def _order(
    moving: np.ndarray, fixed: np.ndarray, order: np.ndarray, labels: tuple[str, ...]
) -> RegistrationWarning:
    rows = np.arange(len(order))
    moved = tuple(labels[i] for i in rows[order != rows])
    before, after = rigid_fre(moving, fixed), rigid_fre(moving[order], fixed)
    if len(moved) == 2:
        fault = f"Points {_listed(moved)} seem to be exchanged; exchange their labels"
    elif (order == rows[::-1]).all():
        fault = (
            f"The moving points ({', '.join(labels)}) are in reverse order; turn one list around"
        )
    else:
        fault = (
            f"The moving points ({', '.join(labels)}) start elsewhere in the list: the one "
            f"at {labels[order[0]]} belongs to the fixed point {labels[0]}; start both lists alike"
        )
    message = f"{fault} (rigid FRE {before:.1f} mm, in the right order {after:.1f} mm)."
    return RegistrationWarning("order", moved, message)


def _outliers(
    moving: np.ndarray, fixed: np.ndarray, bad: tuple[int, ...], labels: tuple[str, ...]
) -> list[RegistrationWarning]:
    if not bad:
        return []
    good = np.delete(np.arange(len(moving)), bad)
    matrix = fit(moving[good], fixed[good], RIGID)
    before, after = rigid_fre(moving, fixed), rigid_fre(moving[good], fixed[good])
    warnings = []
    for i in bad:
        distance = np.linalg.norm(transforms.apply(matrix, moving[i]) - fixed[i])
        message = (
            f"Point {labels[i]} lies {distance:.1f} mm from where the {len(good)} points that fit "
            f"put it; touch it again or leave it out (rigid FRE {before:.1f} mm, without "
            f"{_listed(tuple(labels[j] for j in bad))} {after:.1f} mm)."
        )
        warnings.append(RegistrationWarning("outlier", (labels[i],), message))
    return warnings


def _poor_fit(
    moving: np.ndarray, fixed: np.ndarray, labels: tuple[str, ...]
) -> list[RegistrationWarning]:
    if not is_poor_fit(moving, fixed):
        return []
    message = (
        f"The points ({', '.join(labels)}) do not match: the rigid FRE of "
        f"{rigid_fre(moving, fixed):.1f} mm is more than a fifth of their extent; check that both "
        "lists are of the same task and in the same order."
    )
    return [RegistrationWarning("poor-fit", labels, message)]


def _listed(names: tuple[str, ...]) -> str:
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1]
