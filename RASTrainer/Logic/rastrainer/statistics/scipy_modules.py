"""Scipy modules for the statistics of reports, imported when first needed.

3D Slicer includes scipy; the simulator's installation does not need it, except for reports, power
calculations and groups of trainees. Everything needed for trials and registration uses numpy
(`rastrainer.registration.distributions`).
"""

from __future__ import annotations

import importlib
from types import ModuleType

from rastrainer.errors import InputError


def scipy_module(name: str) -> ModuleType:
    """Return a module of scipy, such as `stats`.

    Raises:
        InputError: scipy is not installed.
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
