"""Registration of touched points (moving, `World`) to fiducials (fixed, MRI RAS), in mm."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.checks import check_points, check_weights
from rastrainer.registration.fits import AFFINE, RIGID, SIMILARITY, fit, leave_one_out
from rastrainer.registration.warnings import RegistrationWarning, find_warnings


@dataclass(frozen=True, eq=False)
class Registration:
    """A fit of paired points and how well it fits them.

    Attributes:
        kind: `rigid`, `similarity` or `affine`.
        labels: Names of the n points.
        moving_mm: (n, 3) float, the points that were mapped.
        fixed_mm: (n, 3) float, where they belong.
        matrix: (4, 4) float, maps moving to fixed.
        fre_mm: Fiducial registration error √(mean |T(m) − f|²), in the fixed space. It does not
            predict the target error of a single case (Fitzpatrick 2009).
        residual_vectors_mm: (n, 3) float, T(m) − f.
        residuals_mm: (n,) float, their lengths.
        warnings: What looks wrong with the points, judged as if all were localized equally well.
        weights: (n,) float, of the points in the fit; None where all count alike.
    """

    kind: str
    labels: tuple[str, ...]
    moving_mm: np.ndarray
    fixed_mm: np.ndarray
    matrix: np.ndarray
    fre_mm: float
    residual_vectors_mm: np.ndarray
    residuals_mm: np.ndarray
    warnings: tuple[RegistrationWarning, ...]
    weights: np.ndarray | None = None

    @property
    def weighted_fre_mm(self) -> float:
        """√(Σ wᵢ|T(mᵢ) − fᵢ|² / Σ wᵢ), which the fit makes least; the FRE without weights."""
        return float(np.sqrt(np.average(self.residuals_mm**2, weights=self.weights)))

    def without(self, *labels: str) -> Registration:
        """Return the registration of the same points without those of the given labels.

        Raises:
            InputError: no point has such a label, or too few points are left.
        """
        for label in labels:
            if label not in self.labels:
                raise InputError(
                    f"No point is labeled {json.dumps(label)}; "
                    f"the labels are {', '.join(self.labels)}."
                )
        kept = [i for i, label in enumerate(self.labels) if label not in labels]
        return register(
            self.moving_mm[kept],
            self.fixed_mm[kept],
            self.kind,
            [self.labels[i] for i in kept],
            None if self.weights is None else self.weights[kept],
        )

    def leave_one_out_mm(self) -> np.ndarray:
        """Return how far each point lies from where the other points put it, (n,) float, in mm.

        Raises:
            InputError: without one of them, too few points are left or they lie on a line (for an
                affine registration: in a plane).
        """
        for i in range(len(self.labels)):
            kept = np.arange(len(self.labels)) != i
            check_points(
                self.moving_mm[kept],
                self.fixed_mm[kept],
                self.kind,
                [label for j, label in enumerate(self.labels) if j != i],
            )
        return leave_one_out(self.moving_mm, self.fixed_mm, self.kind, self.weights)


def register(
    moving: np.ndarray,
    fixed: np.ndarray,
    kind: str = RIGID,
    labels: Sequence[str] | None = None,
    weights: np.ndarray | None = None,
) -> Registration:
    """Fit moving points to fixed points.

    Rigid is the singular value decomposition of Arun (1987) with the determinant guard of Umeyama
    (1991); similarity adds the symmetric scale √(Σ|b|²/Σ|a|²); affine is least squares. All
    three agree with `vtkLandmarkTransform`, which Slicer's own registration uses.

    Args:
        moving: (n, 3) float, in mm.
        fixed: (n, 3) float, in mm, paired with `moving` row by row.
        kind: `rigid`, `similarity` or `affine`.
        labels: Names of the points; `1` to `n` when left out.
        weights: (n,) float, above 0, for a rigid fit: how much each point counts. Where each is
            localized with its own error, 1/FLE² give the most exact fit; only their ratios matter.

    Raises:
        InputError: the points cannot be registered (see `rastrainer.registration.checks`).
    """
    moving, fixed, labels = check_points(moving, fixed, kind, labels)
    weights = check_weights(weights, kind, labels)
    matrix = fit(moving, fixed, kind, weights)
    residual_vectors = transforms.apply(matrix, moving) - fixed
    residuals = np.linalg.norm(residual_vectors, axis=1)
    for values in (moving, fixed, matrix, residual_vectors, residuals):
        values.flags.writeable = False
    return Registration(
        kind=kind,
        labels=labels,
        moving_mm=moving,
        fixed_mm=fixed,
        matrix=matrix,
        fre_mm=float(np.sqrt(np.mean(residuals**2))),
        residual_vectors_mm=residual_vectors,
        residuals_mm=residuals,
        warnings=find_warnings(moving, fixed, kind, labels),
        weights=weights,
    )


def register_all_kinds(
    moving: np.ndarray,
    fixed: np.ndarray,
    labels: Sequence[str] | None = None,
    weights: np.ndarray | None = None,
) -> dict[str, Registration]:
    """Return the fits by kind: the rigid one, and the similarity and affine ones that are possible.

    Args:
        moving: as of `register`, as the others.
        fixed: points in the order of the moving ones.
        labels: of the points.
        weights: of the points in the rigid fit; the other kinds have none.

    Raises:
        InputError: the points do not allow a rigid registration.
    """
    fits = {RIGID: register(moving, fixed, RIGID, labels, weights)}
    for kind in (SIMILARITY, AFFINE):
        # Points in one plane, for example, allow no affine fit.
        with contextlib.suppress(InputError):
            fits[kind] = register(moving, fixed, kind, labels)
    return fits
