"""Psycopg, the one package that a study in PostgreSQL needs; loaded only for such a study.

It is installed with the simulator. Slicer's Python runs the simulator, so its copy fits Slicer,
too, and is loaded from the simulator's private folder: nothing is installed into Slicer.
"""

from __future__ import annotations

import importlib
import math
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

from rastrainer.errors import InputError

_folders: list[Path] = []


def search_driver_in(folder: Path) -> None:
    """Have the package loaded from a private folder where this Python has none of its own."""
    if folder not in _folders:
        _folders.append(folder)


def postgres_driver() -> ModuleType:
    """Return the module `psycopg`.

    Raises:
        InputError: it is not installed.
    """
    searched = [str(folder) for folder in _folders if folder.is_dir()]
    # Last, and only meanwhile: nothing else of Slicer finds what is in the simulator's folder.
    sys.path.extend(searched)
    try:
        return importlib.import_module("psycopg")
    except ImportError:
        raise InputError(
            "A study in PostgreSQL needs the package psycopg, which comes with the simulator: set "
            "the simulator up first, in the section Simulator."
        ) from None
    finally:
        for folder in searched:
            sys.path.remove(folder)


def refuse_infinite_numbers(connection: Any) -> None:
    """Have numbers refused that SQLite and JSON cannot hold; only other programs store them."""
    base = importlib.import_module("psycopg.types.numeric").FloatLoader
    connection.adapters.register_loader("float8", type("FiniteLoader", (base,), {"load": _finite}))


def _finite(_loader: Any, data: Any) -> float:
    value = float(bytes(data))
    if not math.isfinite(value):
        raise InputError("The study holds a value that RASTrainer did not write.")
    return value
