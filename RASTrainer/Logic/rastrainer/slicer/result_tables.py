"""The numbers of a registration as table nodes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rastrainer.registration import Registration
from rastrainer.slicer.scene import Role
from rastrainer.slicer.tables import Column, showTable
from rastrainer.target_error import TargetError


def showResiduals(
    scene: Any, registration: Registration, leaveOneOut: Sequence[float] | None = None
) -> Any:
    """Show the residual of each fiducial in a `vtkMRMLTableNode` and return it.

    Args:
        scene: the scene.
        registration: whose residuals are shown.
        leaveOneOut: how far each touch lies from where the other pairs put it, mm; None where
            they are too few to tell.
    """
    vectors = registration.residual_vectors_mm
    leftOut = [None] * len(registration.labels) if leaveOneOut is None else leaveOneOut
    return showTable(
        scene,
        Role.RESIDUALS,
        "Residuals",
        [
            Column("fiducial", registration.labels, isText=True),
            Column("residual (mm)", registration.residuals_mm),
            Column("residual R (mm)", vectors[:, 0]),
            Column("residual A (mm)", vectors[:, 1]),
            Column("residual S (mm)", vectors[:, 2]),
            Column("without it (mm)", leftOut),
        ],
    )


def showFits(
    scene: Any, fits: Sequence[Registration], targetErrors: Sequence[TargetError | None]
) -> Any:
    """Compare fits of the same points in a `vtkMRMLTableNode` and return it.

    Args:
        scene: the scene.
        fits: one a row.
        targetErrors: of each fit, what to expect at the target; None where it tells nothing.
    """
    known = [(e.expected_mm, *e.interval_mm) if e else (None, None, None) for e in targetErrors]
    return showTable(
        scene,
        Role.FITS,
        "Fits",
        [
            Column("fit", [fit.kind for fit in fits], isText=True),
            Column("FRE (mm)", [fit.fre_mm for fit in fits]),
            Column("largest residual (mm)", [fit.residuals_mm.max() for fit in fits]),
            Column("expected TRE (mm)", [expected for expected, _low, _high in known]),
            Column("TRE from, 95 % (mm)", [low for _expected, low, _high in known]),
            Column("TRE to, 95 % (mm)", [high for _expected, _low, high in known]),
        ],
    )
