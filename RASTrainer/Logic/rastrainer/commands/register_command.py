"""`rastrainer register MOVING FIXED`: registers two files of points."""

from __future__ import annotations

import argparse
import json
from typing import Any

from rastrainer.commands.text_table import text_table
from rastrainer.errors import InputError
from rastrainer.localization_error import degrees_of_freedom
from rastrainer.point_files import read_points
from rastrainer.point_list import pair
from rastrainer.registration import KINDS, RIGID, Registration, register
from rastrainer.target_error import INTERVAL_NOTE, TargetError, target_error

FRE_NOTE = (
    "FRE is the error at the fiducials; it does not predict the error at a target in a single case."
)


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the command to a command line; `arguments.run(arguments)` runs it."""
    parser = subparsers.add_parser(
        "register",
        help="register moving points to fixed points",
        description=(
            "Register two files of points: CSV with the header label,x,y,z (mm), or Slicer's "
            ".mrk.json. Points are paired by label, or by order where the labels are left out."
        ),
    )
    parser.add_argument("moving", metavar="MOVING", help="the points to be mapped")
    parser.add_argument("fixed", metavar="FIXED", help="where they belong")
    parser.add_argument("--type", choices=KINDS, default=RIGID, help="default: %(default)s")
    parser.add_argument(
        "--target",
        nargs=3,
        type=float,
        metavar=("X", "Y", "Z"),
        help="point in the fixed space (mm) to tell the expected error of; default: the centroid",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Print the registration and return the exit status.

    Raises:
        InputError: a file cannot be used, or the points cannot be registered.
    """
    labels, moving, fixed = pair(read_points(arguments.moving), read_points(arguments.fixed))
    registration = register(moving, fixed, arguments.type, labels)
    error = _target_error(registration, arguments.target)
    if arguments.json:
        print(json.dumps(registration_json(registration, error), allow_nan=False, indent=1))
    else:
        print(registration_text(registration, error))
    return 0


def registration_json(registration: Registration, error: TargetError | None) -> dict[str, Any]:
    """Return a registration as a JSON object; `expected_tre` is None where nothing is known."""
    return {
        "type": registration.kind,
        "fre_mm": registration.fre_mm,
        "matrix": registration.matrix.tolist(),
        "labels": list(registration.labels),
        "residuals_mm": registration.residuals_mm.tolist(),
        "residual_vectors_mm": registration.residual_vectors_mm.tolist(),
        "warnings": [warning.to_json() for warning in registration.warnings],
        "expected_tre": None
        if error is None
        else {
            "target_mm": list(error.target_mm),
            "expected_mm": error.expected_mm,
            "independent_mm": error.independent_mm,
            "interval_mm": list(error.interval_mm),
            "confidence": error.confidence,
            "fle_mm": error.fle_mm,
            "note": INTERVAL_NOTE,
        },
    }


def registration_text(registration: Registration, error: TargetError | None) -> str:
    """Return a registration as text for people, with units and warnings."""
    count = len(registration.labels)
    vectors = registration.residual_vectors_mm
    lines = [
        f"{registration.kind.capitalize()} registration of {count} pairs of points",
        "",
        f"FRE  {registration.fre_mm:.3f} mm (root mean square of the residuals)",
    ]
    if error is not None:
        x, y, z = error.target_mm
        low, high = error.interval_mm
        lines += [
            f"TRE  {error.expected_mm:.3f} mm expected at ({x:.1f}, {y:.1f}, {z:.1f}), "
            f"{error.confidence:.0%} interval from {low:.3f} to {high:.3f} mm",
            INTERVAL_NOTE,
        ]
    lines += [FRE_NOTE, "", "Moving to fixed (mm)"]
    lines += ["  ".join(f"{value:12.6f}" for value in row) for row in registration.matrix]
    lines += [
        "",
        text_table(
            ["Point", "Residual (mm)", "x", "y", "z"],
            [
                [label, f"{length:.3f}", *(f"{value:+.3f}" for value in vector)]
                for label, length, vector in zip(
                    registration.labels, registration.residuals_mm, vectors, strict=True
                )
            ],
        ),
    ]
    if registration.warnings:
        lines += ["", *(f"Warning: {warning.message}" for warning in registration.warnings)]
    return "\n".join(lines)


def _target_error(registration: Registration, target: list[float] | None) -> TargetError | None:
    if target is not None:
        return target_error(registration, target)
    try:
        degrees_of_freedom(registration)
    except InputError:
        return None
    return target_error(registration, registration.fixed_mm.mean(axis=0))
