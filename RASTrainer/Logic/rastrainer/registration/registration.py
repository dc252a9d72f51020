"""Registration of touched points (moving, `World`) to fiducials (fixed, MRI RAS), in mm.

Points that are unfit for it raise an error that names the fault; `rastrainer.registration.warnings`
has faults that still allow a fit, such as a mirrored set.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, points_of
from rastrainer.registration import fits
from rastrainer.registration.warnings import RegistrationWarning, find_warnings


@dataclass(frozen=True, eq=False)
class Registration:
    """A fit of paired points and how well it fits them.

    Attributes:
        moving_mm: (n, 3) float, the points that were mapped.
        fixed_mm: (n, 3) float, where they belong.
        matrix: (4, 4) float, maps moving to fixed.
        fre_mm: Fiducial registration error √(mean |T(m) − f|²), in the fixed space. It does not
            predict the target error of a single case (Fitzpatrick 2009).
        residual_vectors_mm: (n, 3) float, T(m) − f.
        residuals_mm: (n,) float, their lengths.
        warnings: What looks wrong with the points, judged as if all were localized equally well.
        weights: (n,) float, of the points in the fit; None if all count alike.
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
        """Return the registration without the points of the given labels."""
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
        """Return how far each point lies from where the other points put it, (n,) float, in mm."""
        rows = np.arange(len(self.labels))
        distances = np.empty(len(rows))
        for left_out in rows:
            others = rows != left_out
            labels = [self.labels[row] for row in rows[others]]
            moving, fixed, _ = check_points(
                self.moving_mm[others], self.fixed_mm[others], self.kind, labels
            )
            weights = None if self.weights is None else self.weights[others]
            matrix = fits.fit(moving, fixed, self.kind, weights)
            there = transforms.apply(matrix, self.moving_mm[left_out])
            distances[left_out] = np.linalg.norm(there - self.fixed_mm[left_out])
        return distances


def register(
    moving: np.ndarray,
    fixed: np.ndarray,
    kind: str = fits.RIGID,
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
    """
    moving, fixed, labels = check_points(moving, fixed, kind, labels)
    weights = check_weights(weights, kind, labels)
    matrix = fits.fit(moving, fixed, kind, weights)
    residual_vectors = transforms.apply(matrix, moving) - fixed
    residuals = np.linalg.norm(residual_vectors, axis=1)
    for values in (matrix, residual_vectors, residuals):
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
        warnings=tuple(find_warnings(moving, fixed, kind, labels)),
        weights=weights,
    )


def register_all_kinds(
    moving: np.ndarray,
    fixed: np.ndarray,
    labels: Sequence[str] | None = None,
    weights: np.ndarray | None = None,
) -> dict[str, Registration]:
    """Return the fits by kind: rigid, and similarity and affine if they are possible.

    Only the rigid fit has weights.
    """
    found = {fits.RIGID: register(moving, fixed, fits.RIGID, labels, weights)}
    for kind in (fits.SIMILARITY, fits.AFFINE):
        # Points in one plane, for example, allow no affine fit.
        with contextlib.suppress(InputError):
            found[kind] = register(moving, fixed, kind, labels)
    return found


POINT_LIMIT = 1000
WEIGHT_SPAN = 1e12
"""The largest weight against the smallest: localization errors from 1 µm to 1 m."""
FLAT = 1e-3
"""A set counts as a line (a plane) if the ratio of its extents across and along is this small."""


def check_points(
    moving: np.ndarray, fixed: np.ndarray, kind: str, labels: Sequence[str] | None = None
) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Return copies of both point sets, (n, 3) float in mm, and their labels."""
    if kind not in fits.KINDS:
        raise InputError(
            f"The registration type {json.dumps(str(kind)[:40])} is unknown; "
            f"it must be one of {', '.join(fits.KINDS)}."
        )
    sets = {
        which: points_of(points, f"The {which} points cannot be used")
        for which, points in (("moving", moving), ("fixed", fixed))
    }
    count = len(sets["moving"])
    if count != len(sets["fixed"]):
        raise InputError(
            f"There are {count} moving points and {len(sets['fixed'])} fixed points; "
            "each must have its partner in the other list."
        )
    if count < fits.MINIMUM_POINTS[kind]:
        raise InputError(
            f"{kind.capitalize()} registration needs at least {fits.MINIMUM_POINTS[kind]} pairs of "
            f"points; there {'is' if count == 1 else 'are'} only {count}."
        )
    if count > POINT_LIMIT:
        raise InputError(f"There are {count} pairs of points; at most {POINT_LIMIT} are accepted.")
    names = tuple(str(i + 1) for i in range(count)) if labels is None else tuple(map(str, labels))
    PointList(names, sets["moving"])
    for which, points in sets.items():
        _check_extent(points, which, kind, names)
    return sets["moving"], sets["fixed"], names


def check_weights(
    weights: np.ndarray | None, kind: str, labels: Sequence[str]
) -> np.ndarray | None:
    """Return a copy of the weights, (n,) float that cannot be written to, or None for none."""
    if weights is None:
        return None
    if kind != fits.RIGID:
        raise InputError(f"Weights are for rigid registrations; {kind} has none.")
    try:
        array = np.array(weights, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError("The weights must be numbers, one for each pair of points.") from None
    if array.shape != (len(labels),):
        raise InputError(f"There must be {len(labels)} weights, one for each pair of points.")
    for label, weight in zip(labels, array, strict=True):
        if not (np.isfinite(weight) and weight > 0.0):
            raise InputError(f"The weight of point {label} must be a number above 0.")
    if array.max() > WEIGHT_SPAN * array.min():
        raise InputError(
            f"The largest weight may be at most {WEIGHT_SPAN:g} times the smallest; leave out the "
            "points that hardly count."
        )
    array.flags.writeable = False
    return array


def _check_extent(points: np.ndarray, which: str, kind: str, labels: tuple[str, ...]) -> None:
    along, across, out_of_plane = fits.extents(points)
    names = ", ".join(labels)
    # Doubles hold about 16 digits of the coordinates; a smaller extent is none.
    if along <= 1e-12 * max(1.0, np.abs(points).max()):
        raise InputError(f"All {which} points ({names}) are at the same place.")
    if across < FLAT * along:
        raise InputError(
            f"The {which} points ({names}) lie on one line, so the rotation about it is "
            "undetermined; add a point well away from it."
        )
    if kind == fits.AFFINE and out_of_plane < FLAT * along:
        raise InputError(
            f"The {which} points ({names}) lie in one plane, so an affine registration is "
            "undetermined; add a point well away from it, or choose rigid."
        )
