"""The modules of scipy that the statistics of a report use, imported when they are first needed.

3D Slicer brings scipy along. The simulator's own installation does without it: only a report, a
calculation of power, and groups of trainees ask for it. What is needed while trials are played and
registered stands on numpy (`rastrainer.registration.distributions`).
"""

from __future__ import annotations

import importlib
from types import ModuleType

from rastrainer.errors import InputError


def scipy_module(name: str) -> ModuleType:
    """Return a module of scipy, such as `stats`.

    Raises:
        InputError: scipy is not installed; the sentence says how it is.
    """
    try:
        return importlib.import_module(f"scipy.{name}")
    except ModuleNotFoundError as error:
        if not (error.name or "").startswith("scipy"):
            raise
        raise InputError(
            "The statistics of studies need scipy, which is not installed here: "
            "pip install scipy (3D Slicer brings it along)."
        ) from None
