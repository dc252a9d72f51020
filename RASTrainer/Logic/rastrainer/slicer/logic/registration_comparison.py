"""The fits of the same pairs side by side, computed from plain data, in any thread."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.registration.fits import RIGID
from rastrainer.registration.localization_error import LocalizationError
from rastrainer.registration.registration import Registration, register_all_kinds
from rastrainer.registration.target_error import TargetError, expected_tre, target_error
from rastrainer.slicer.scene.registration_input import Choices, Pairs, Remedy, SkinNormals, remedyOf


@dataclass(frozen=True, eq=False)
class Comparison:
    """The fits of the same pairs side by side.

    Attributes:
        shown: the fit of the wanted kind; the rigid one where the pairs do not allow that kind.
        fits: by kind; those that the pairs allow, rigid always.
        localizations: by kind, the error of the touches along and across the skin; None where
            nothing but an error that is alike in all directions is known.
        errors: by kind, what to expect at the target; those that are known.
        leaveOneOut: by kind, (n,) float, mm, how far each touch lies from where the other pairs
            put it; those for which the pairs are enough.
        remedies: the warnings, each with what one click can do.
        headErrors: (v,) float, mm, what to expect at each point of the head with the shown fit;
            None where the head is not colored, or nothing is known.
    """

    pairs: Pairs
    shown: Registration
    fits: Mapping[str, Registration]
    localizations: Mapping[str, LocalizationError | None]
    errors: Mapping[str, TargetError]
    leaveOneOut: Mapping[str, np.ndarray]
    remedies: tuple[Remedy, ...]
    headErrors: np.ndarray | None

    def targetError(self, place: np.ndarray) -> TargetError:
        """Return the error to expect with the shown fit at a place, (3,) float, RAS mm."""
        return target_error(self.shown, place, self.localizations[self.shown.kind])


def compareFits(
    pairs: Pairs,
    choices: Choices,
    kind: str,
    target: np.ndarray | None,
    skin: SkinNormals | None,
    headPoints: np.ndarray | None,
) -> Comparison:
    """Register pairs in all ways.

    Args:
        choices: by which they were chosen.
        kind: of the fit that is shown.
        target: (3,) float, RAS mm, where errors are reported; None where there is no target.
        skin: of the head; None where there is no head.
        headPoints: (v, 3) float, RAS mm, the points of a head that is to be colored, else None.
    """
    fits = register_all_kinds(
        pairs.moving, pairs.fixed, pairs.labels, choices.weights(pairs.labels)
    )
    # Errors stated for single points replace those estimated from the skin.
    localizations = {
        kind: None if skin is None or fit.weights is not None else skin.localizationError(fit)
        for kind, fit in fits.items()
    }
    errors, leaveOneOut = {}, {}
    for each, fit in fits.items():
        with contextlib.suppress(InputError):
            if target is not None:
                errors[each] = target_error(fit, target, localizations[each])
        with contextlib.suppress(InputError):
            leaveOneOut[each] = fit.leave_one_out_mm()
    shown, headErrors = fits.get(kind, fits[RIGID]), None
    if headPoints is not None:
        with contextlib.suppress(InputError):
            headErrors = expected_tre(shown, headPoints, localizations[shown.kind])
    rigid = fits[RIGID]
    found = tuple(remedyOf(warning, rigid, choices) for warning in rigid.warnings)
    return Comparison(pairs, shown, fits, localizations, errors, leaveOneOut, found, headErrors)
