"""What one click can do about a warning of a registration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.registration.checks import extents
from rastrainer.registration.faults import find_order
from rastrainer.registration.registration import Registration
from rastrainer.registration.warnings import SAME_PLACE, RegistrationWarning
from rastrainer.slicer.scene.registration_input import Choices
from rastrainer.slicer.translation import _


@dataclass(frozen=True)
class Remedy:
    """A warning with its button.

    Attributes:
        warning: with its sentence and its points.
        title: of the button; empty where only the points themselves can be mended.
        choices: of the pairs once the button is pressed.
    """

    warning: RegistrationWarning
    title: str
    choices: Choices


def remedies(registration: Registration, choices: Choices) -> tuple[Remedy, ...]:
    """Return each warning of a rigid registration with what one click can do about it."""
    return tuple(_remedy(warning, registration, choices) for warning in registration.warnings)


def _remedy(warning: RegistrationWarning, registration: Registration, choices: Choices) -> Remedy:
    if warning.code == "outlier":
        return _leaveOut(warning, warning.points, choices)
    if warning.code == "duplicate":
        # The first of them may stay: one point at a place is no duplicate.
        return _leaveOut(warning, _laterTwins(warning, registration), choices)
    if warning.code == "order":
        order = find_order(registration.moving_mm, registration.fixed_mm)
        if order is not None:
            labels = registration.labels
            names = {labels[source]: labels[row] for row, source in enumerate(order)}
            changed = {old: new for old, new in names.items() if old != new}
            return Remedy(warning, _("Put in order"), choices.rename(changed))
    return Remedy(warning, "", choices)


def _leaveOut(warning: RegistrationWarning, labels: tuple[str, ...], choices: Choices) -> Remedy:
    title = _("Leave out {labels}").format(labels=", ".join(labels))
    return Remedy(warning, title, choices.without(labels))


def _laterTwins(warning: RegistrationWarning, registration: Registration) -> tuple[str, ...]:
    """Return the labels of the points that lie where an earlier one lies."""
    later: list[str] = []
    for points in (registration.moving_mm, registration.fixed_mm):
        limit = SAME_PLACE * np.linalg.norm(extents(points))
        rows = [registration.labels.index(label) for label in warning.points]
        for position, row in enumerate(rows):
            gaps = np.linalg.norm(points[rows[:position]] - points[row], axis=1)
            if (gaps <= limit).any() and registration.labels[row] not in later:
                later.append(registration.labels[row])
    return tuple(later)
