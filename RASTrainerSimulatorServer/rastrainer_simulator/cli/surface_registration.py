"""`rastrainer register … --surface TRACE`: a trace over the skin registered to a head."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_list import pair, read_points
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.registration.registration import register
from rastrainer.registration.surface_error import knowledge_of, surface_target_error
from rastrainer.registration.surface_match import SurfaceMatch, match_surface
from rastrainer.registration.target_error import TargetError

RESIDUAL_NOTE = (
    "The residual is the distance of the points from the skin; a small one does not mean a small "
    "error at a target."
)


def match_files(arguments: argparse.Namespace) -> tuple[SurfaceMatch, TargetError]:
    """Return the match of a command's files and the error to expect at its target.

    The points MOVING and FIXED, three landmarks or more, give the start.

    Raises:
        InputError: a file cannot be used, or its points cannot be matched.
    """
    for option in ("type", "fle", "weights"):
        if getattr(arguments, option) not in (None, "rigid"):
            raise InputError(f"--surface matches rigidly and unweighted: leave out --{option}.")
    mesh = _head(arguments.head)
    labels, moving, fixed = pair(read_points(arguments.moving), read_points(arguments.fixed))
    trace = read_points(arguments.surface).points
    match = match_surface(trace, mesh, register(moving, fixed, labels=labels).matrix)
    target = mesh.middle if arguments.target is None else np.array(arguments.target)
    return match, surface_target_error(knowledge_of(match), target)


def _head(path: Path | None) -> HeadMesh:
    if path is None:
        raise InputError("--surface needs the head: give its mesh with --head HEAD.ply.")
    return read_head_mesh(path)


def match_json(match: SurfaceMatch, error: TargetError) -> dict[str, Any]:
    """Return a match as a JSON object."""
    return {
        "type": "surface",
        "matrix": match.matrix.tolist(),
        "points": len(match.residuals_mm),
        "rms_mm": match.rms_mm,
        "inlier_share": match.inlier_share,
        "converged": match.converged,
        "starts": match.starts,
        "best_starts": match.best_starts,
        "spread_mm": match.spread_mm,
        "slide_mm": match.slide.distance_mm,
        "slide_place": match.slide.place,
        "residuals_mm": match.residuals_mm.tolist(),
        "warnings": [warning.to_json() for warning in match.warnings],
        "expected_tre": {
            "target_mm": list(error.target_mm),
            "expected_mm": error.expected_mm,
            "interval_mm": list(error.interval_mm),
            "confidence": error.confidence,
            "note": RESIDUAL_NOTE,
        },
    }


def match_text(match: SurfaceMatch, error: TargetError) -> str:
    """Return a match as text for people, with units and warnings."""
    x, y, z = error.target_mm
    low, high = error.interval_mm
    slide = match.slide
    lines = [
        f"Surface registration of {len(match.residuals_mm)} points",
        "",
        f"Residual  {match.rms_mm:.3f} mm (root mean square of the points that count, "
        f"{match.inlier_share:.0%})",
        f"TRE       {error.expected_mm:.3f} mm expected at ({x:.1f}, {y:.1f}, {z:.1f}), "
        f"{error.confidence:.0%} interval from {low:.3f} to {high:.3f} mm",
        f"Slide     {slide.distance_mm:.1f} mm at most in the brain, {slide.way}; largest at the "
        f"{slide.place} of the head",
        f"Starts    {match.best_starts} of {match.starts} ended here; "
        f"spread {match.spread_mm:.1f} mm",
        RESIDUAL_NOTE,
        "",
        "Trace to head (mm)",
    ]
    lines += ["  ".join(f"{value:12.6f}" for value in row) for row in match.matrix]
    if match.warnings:
        lines += ["", *(f"Warning: {warning.message}" for warning in match.warnings)]
    return "\n".join(lines)
