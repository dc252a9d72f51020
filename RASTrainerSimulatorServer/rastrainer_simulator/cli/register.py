"""`rastrainer register MOVING FIXED`: registers two files of points, or a trace to a surface."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_point_numbers, read_points
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import read_head_mesh
from rastrainer.registration.localization_error import (
    LocalizationError,
    degrees_of_freedom,
    expected_fre,
    misfit_probability,
    stated_error,
)
from rastrainer.registration.registration import Registration, register
from rastrainer.registration.surface_error import knowledge_of, surface_target_error
from rastrainer.registration.surface_match import match_surface
from rastrainer.registration.target_error import INTERVAL_NOTE, TargetError, target_error
from rastrainer_simulator.cli.printing import json_text, picked, text_table

FRE_NOTE = (
    "FRE is the error at the fiducials; it does not predict the error at a target in a single case."
)

FLE_RANGE_MM = (1e-3, 1e3)
WEIGHT_RANGE = (1e-6, 1e6)
MISFIT_LEVEL = 1e-3
RESIDUAL_NOTE = (
    "The residual is the distance of the points from the skin; a small one does not mean a small "
    "error at a target."
)


def register_points(arguments: argparse.Namespace) -> int:
    _check_options(arguments)
    left_out: dict[str, tuple[str, ...]] = {}

    def read(name: str) -> PointList:
        points = read_points(name)
        if points.left_out:
            left_out[name] = points.left_out_names
        return points

    paired = pair(read(arguments.moving), read(arguments.fixed))
    if arguments.surface is None:
        answer, lines, warnings = _registered(arguments, *paired)
    else:
        answer, lines, warnings = _matched(arguments, read, *paired)
    if arguments.json:
        print(json_text({**answer, "left_out": left_out}))
        return 0
    print("\n".join(lines + ([""] if warnings else [])))
    for warning in warnings:
        print(f"Warning: {warning}")
    for name, names in left_out.items():
        print(f"Left out of {name}, deselected or not placed in Slicer: {', '.join(names)}")
    return 0


def _check_options(arguments: argparse.Namespace) -> None:
    """Refuse options that exclude each other, before any file is read."""
    if arguments.surface is not None:
        for name in ("type", "fle", "weights"):
            if getattr(arguments, name) not in (None, "rigid"):
                raise InputError(f"--surface matches rigidly and unweighted: leave out --{name}.")
        if arguments.head is None:
            raise InputError("--surface needs the head: give its mesh with --head HEAD.ply.")
    elif arguments.fle is not None and arguments.weights is not None:
        raise InputError("--fle and --weights exclude each other.")


Answer = tuple[dict[str, Any], list[str], list[str]]
"""An answer as a JSON object, the same as lines of text, and its warnings."""


def _registered(
    arguments: argparse.Namespace, labels: tuple[str, ...], moving: np.ndarray, fixed: np.ndarray
) -> Answer:
    """Register points to points; the stated FLE are the RMS lengths of their errors."""
    fle_mm = weights = localization = stated = None
    if arguments.fle is not None:
        fle_mm = read_point_numbers(arguments.fle, "fle", labels, *FLE_RANGE_MM)
        weights, localization = 1.0 / fle_mm**2, stated_error(fle_mm)
    elif arguments.weights is not None:
        weights = read_point_numbers(arguments.weights, "weight", labels, *WEIGHT_RANGE)
    found = register(moving, fixed, arguments.type, labels, weights)
    warnings = [warning.message for warning in found.warnings]
    lines = [
        f"{found.kind.capitalize()} registration of {len(found.labels)} pairs of points"
        + ("" if weights is None else ", weighted"),
        "",
        f"FRE  {found.fre_mm:.3f} mm (root mean square of the residuals)",
    ]
    if weights is not None:
        lines.append(f"     {found.weighted_fre_mm:.3f} mm with the weights")
    if fle_mm is not None and localization is not None:
        expected_mm, misfit = expected_fre(found, localization), misfit_probability(found, fle_mm)
        stated = {"fle_mm": fle_mm, "expected_fre_mm": expected_mm, "misfit_probability": misfit}
        lines.append(f"     {expected_mm:.3f} mm to be expected from the stated FLE")
        if misfit < MISFIT_LEVEL:
            warnings.append(
                "The residuals are larger than the stated FLE allow; the expected TRE, which is "
                "computed from these, is too small."
            )
    error = _target_error(found, arguments.target, localization)
    if error is not None:
        lines += [f"TRE  {_expected(error)}", INTERVAL_NOTE]
    lines += [FRE_NOTE, "", "Moving to fixed (mm)", *_matrix_lines(found.matrix), ""]
    header, last = ["Point", "Residual (mm)", "x", "y", "z"], weights if fle_mm is None else fle_mm
    rows = [
        [label, f"{length:.3f}", *(f"{value:+.3f}" for value in vector)]
        for label, length, vector in zip(
            found.labels, found.residuals_mm, found.residual_vectors_mm, strict=True
        )
    ]
    if last is not None:
        header.append("Weight" if fle_mm is None else "FLE (mm)")
        rows = [[*row, f"{number:g}"] for row, number in zip(rows, last, strict=True)]
    lines.append(text_table(header, rows))
    names = ("fre_mm", "matrix", "labels", "residuals_mm", "residual_vectors_mm", "warnings")
    answer = {
        "type": found.kind,
        **picked(found, *names, "weights", "weighted_fre_mm"),
        "stated": stated,
        "expected_tre": None if error is None else {**asdict(error), "note": INTERVAL_NOTE},
    }
    return answer, lines, warnings


def _target_error(
    found: Registration, target: ArrayLike | None, localization: LocalizationError | None
) -> TargetError | None:
    """Return the error to expect at a target, or at the center of the points if it is known."""
    if target is None:
        try:
            degrees_of_freedom(found)
        except InputError:
            return None
        target = found.fixed_mm.mean(axis=0)
    return target_error(found, np.array(target), localization)


def _expected(error: TargetError) -> str:
    x, y, z = error.target_mm
    low, high = error.interval_mm
    return (
        f"{error.expected_mm:.3f} mm expected at ({x:.1f}, {y:.1f}, {z:.1f}), "
        f"{error.confidence:.0%} interval from {low:.3f} to {high:.3f} mm"
    )


def _matrix_lines(matrix: np.ndarray) -> list[str]:
    return ["  ".join(f"{value:12.6f}" for value in row) for row in matrix]


def _matched(
    arguments: argparse.Namespace,
    read: Callable[[str], PointList],
    labels: tuple[str, ...],
    moving: np.ndarray,
    fixed: np.ndarray,
) -> Answer:
    """Match a trace to a head; the paired points, three landmarks or more, give the start."""
    mesh, trace = read_head_mesh(arguments.head), read(arguments.surface).points
    match = match_surface(trace, mesh, register(moving, fixed, labels=labels).matrix)
    target = mesh.middle if arguments.target is None else np.array(arguments.target)
    error, slide = surface_target_error(knowledge_of(match), target), match.slide
    names = ("rms_mm", "inlier_share", "converged", "starts", "best_starts", "spread_mm")
    answer = {
        "type": "surface",
        "points": len(match.residuals_mm),
        "slide_mm": slide.distance_mm,
        "slide_place": slide.place,
        **picked(match, "matrix", *names, "residuals_mm", "warnings"),
        "expected_tre": {**asdict(error), "note": RESIDUAL_NOTE},
    }
    lines = [
        f"Surface registration of {len(match.residuals_mm)} points",
        "",
        f"Residual  {match.rms_mm:.3f} mm (root mean square of the points that count, "
        f"{match.inlier_share:.0%})",
        f"TRE       {_expected(error)}",
        f"Slide     {slide.distance_mm:.1f} mm at most in the brain, {slide.way}; largest at the "
        f"{slide.place} of the head",
        f"Starts    {match.best_starts} of {match.starts} ended here; "
        f"spread {match.spread_mm:.1f} mm",
        RESIDUAL_NOTE,
        "",
        "Trace to head (mm)",
        *_matrix_lines(match.matrix),
    ]
    return answer, lines, [warning.message for warning in match.warnings]
