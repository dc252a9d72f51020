"""`rastrainer register MOVING FIXED`: registers two files of points, or a trace to a surface."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_point_numbers, read_points
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import read_head_mesh
from rastrainer.registration.localization_error import (
    degrees_of_freedom,
    expected_fre,
    misfit_probability,
    stated_error,
)
from rastrainer.registration.registration import Registration, register
from rastrainer.registration.surface_error import knowledge_of, surface_target_error
from rastrainer.registration.surface_match import SurfaceMatch, match_surface
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


@dataclass(frozen=True)
class StatedErrors:
    """The RMS lengths of the points' errors, (n,) float, as the user states them."""

    fle_mm: np.ndarray
    expected_fre_mm: float
    misfit_probability: float


def register_points(arguments: argparse.Namespace) -> int:
    if arguments.fle is not None and arguments.weights is not None:
        raise InputError("--fle and --weights exclude each other.")
    left_out: dict[str, tuple[str, ...]] = {}

    def read(name: str) -> PointList:
        points = read_points(name)
        if points.left_out:
            left_out[name] = points.left_out_names
        return points

    if arguments.surface is None:
        found = register_files(arguments, read)
        answer, text = registration_json(*found), registration_text(*found)
    else:
        match = match_files(arguments, read)
        answer, text = match_json(*match), match_text(*match)
    if arguments.json:
        print(json_text({**answer, "left_out": left_out}))
        return 0
    print(text)
    for name, names in left_out.items():
        print(f"Left out of {name}, deselected or not placed in Slicer: {', '.join(names)}")
    return 0


def register_files(
    arguments: argparse.Namespace, read: Callable[[str], PointList]
) -> tuple[Registration, TargetError | None, StatedErrors | None]:
    """Return the registration of a command's files, the error to expect, and the stated errors."""
    labels, moving, fixed = pair(read(arguments.moving), read(arguments.fixed))
    fle_mm = weights = stated = localization = None
    if arguments.fle is not None:
        fle_mm = read_point_numbers(arguments.fle, "fle", labels, *FLE_RANGE_MM)
        weights = 1.0 / fle_mm**2
    elif arguments.weights is not None:
        weights = read_point_numbers(arguments.weights, "weight", labels, *WEIGHT_RANGE)
    registration = register(moving, fixed, arguments.type, labels, weights)
    if fle_mm is not None:
        localization = stated_error(fle_mm)
        expected_mm = expected_fre(registration, localization)
        stated = StatedErrors(fle_mm, expected_mm, misfit_probability(registration, fle_mm))
    target = arguments.target
    if target is None:
        try:
            degrees_of_freedom(registration)
        except InputError:
            return registration, None, stated
        target = registration.fixed_mm.mean(axis=0)
    return registration, target_error(registration, np.array(target), localization), stated


def registration_json(
    registration: Registration, error: TargetError | None, stated: StatedErrors | None = None
) -> dict[str, Any]:
    """Return a registration as a JSON object; `expected_tre` is None if it is unknown."""
    given = None
    if stated is not None:
        given = picked(stated, "fle_mm", "expected_fre_mm", "misfit_probability")
    names = ("fre_mm", "matrix", "labels", "residuals_mm", "residual_vectors_mm", "warnings")
    return {
        "type": registration.kind,
        **picked(registration, *names, "weights", "weighted_fre_mm"),
        "stated": given,
        "expected_tre": None if error is None else {**asdict(error), "note": INTERVAL_NOTE},
    }


def registration_text(
    registration: Registration, error: TargetError | None, stated: StatedErrors | None = None
) -> str:
    count = len(registration.labels)
    weighted = "" if registration.weights is None else ", weighted"
    lines = [
        f"{registration.kind.capitalize()} registration of {count} pairs of points{weighted}",
        "",
        f"FRE  {registration.fre_mm:.3f} mm (root mean square of the residuals)",
    ]
    if registration.weights is not None:
        lines.append(f"     {registration.weighted_fre_mm:.3f} mm with the weights")
    if stated is not None:
        lines.append(f"     {stated.expected_fre_mm:.3f} mm to be expected from the stated FLE")
    if error is not None:
        lines += [f"TRE  {_expected(error)}", INTERVAL_NOTE]
    lines += [FRE_NOTE, "", "Moving to fixed (mm)", *_matrix_lines(registration.matrix)]
    header, last = ["Point", "Residual (mm)", "x", "y", "z"], None
    if stated is not None:
        header, last = [*header, "FLE (mm)"], stated.fle_mm
    elif registration.weights is not None:
        header, last = [*header, "Weight"], registration.weights
    lengths, vectors = registration.residuals_mm, registration.residual_vectors_mm
    rows = [
        [label, f"{lengths[row]:.3f}", *(f"{value:+.3f}" for value in vectors[row])]
        + ([] if last is None else [f"{last[row]:g}"])
        for row, label in enumerate(registration.labels)
    ]
    lines += ["", text_table(header, rows)]
    warnings = [warning.message for warning in registration.warnings]
    if stated is not None and stated.misfit_probability < MISFIT_LEVEL:
        warnings.append(
            "The residuals are larger than the stated FLE allow; the expected TRE, which is "
            "computed from these, is too small."
        )
    if warnings:
        lines += ["", *(f"Warning: {warning}" for warning in warnings)]
    return "\n".join(lines)


def _expected(error: TargetError) -> str:
    x, y, z = error.target_mm
    low, high = error.interval_mm
    return (
        f"{error.expected_mm:.3f} mm expected at ({x:.1f}, {y:.1f}, {z:.1f}), "
        f"{error.confidence:.0%} interval from {low:.3f} to {high:.3f} mm"
    )


def _matrix_lines(matrix: np.ndarray) -> list[str]:
    return ["  ".join(f"{value:12.6f}" for value in row) for row in matrix]


def match_files(
    arguments: argparse.Namespace, read: Callable[[str], PointList]
) -> tuple[SurfaceMatch, TargetError]:
    """Return the match of a command's files and the error to expect at its target.

    The points MOVING and FIXED, three landmarks or more, give the start.
    """
    for name in ("type", "fle", "weights"):
        if getattr(arguments, name) not in (None, "rigid"):
            raise InputError(f"--surface matches rigidly and unweighted: leave out --{name}.")
    if arguments.head is None:
        raise InputError("--surface needs the head: give its mesh with --head HEAD.ply.")
    mesh = read_head_mesh(arguments.head)
    labels, moving, fixed = pair(read(arguments.moving), read(arguments.fixed))
    trace = read(arguments.surface).points
    match = match_surface(trace, mesh, register(moving, fixed, labels=labels).matrix)
    target = mesh.middle if arguments.target is None else np.array(arguments.target)
    return match, surface_target_error(knowledge_of(match), target)


def match_json(match: SurfaceMatch, error: TargetError) -> dict[str, Any]:
    names = ("rms_mm", "inlier_share", "converged", "starts", "best_starts", "spread_mm")
    return {
        "type": "surface",
        "points": len(match.residuals_mm),
        "slide_mm": match.slide.distance_mm,
        "slide_place": match.slide.place,
        **picked(match, "matrix", *names, "residuals_mm", "warnings"),
        "expected_tre": {**asdict(error), "note": RESIDUAL_NOTE},
    }


def match_text(match: SurfaceMatch, error: TargetError) -> str:
    slide = match.slide
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
    if match.warnings:
        lines += ["", *(f"Warning: {warning.message}" for warning in match.warnings)]
    return "\n".join(lines)
