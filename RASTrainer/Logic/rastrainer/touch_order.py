"""In which order the fiducials of a list that somebody placed by hand are touched."""

from __future__ import annotations

import re
from collections.abc import Sequence

from rastrainer.errors import InputError
from rastrainer.protocol import FIDUCIAL_COUNT

_NUMBER = re.compile(r"(\d{1,6})\s*$")


def touch_order(labels: Sequence[str]) -> list[int]:
    """Return the rows of a list of fifteen fiducials in the order to touch them.

    Numbers at the ends of the labels, such as "7" or Slicer's own "F-7", are the order; without
    any, it is the list's.

    Raises:
        InputError: there are more or fewer fiducials, or their numbers are no order.
    """
    if len(labels) != FIDUCIAL_COUNT:
        raise InputError(f"it has {len(labels)} fiducials; a task has {FIDUCIAL_COUNT}.")
    found = [_NUMBER.search(label) for label in labels]
    if not any(found):
        return list(range(FIDUCIAL_COUNT))
    numbers = [int(match.group(1)) if match else None for match in found]
    if None in numbers or len(set(numbers)) != FIDUCIAL_COUNT:
        raise InputError(
            "some of its labels have no number, or two the same one; number the fiducials from 1 "
            f"to {FIDUCIAL_COUNT} in the order to touch, or none of them."
        )
    return sorted(range(FIDUCIAL_COUNT), key=numbers.__getitem__)
