"""Which Python and which package set the simulator up, and where its private folder is."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from rastrainer import __version__
from rastrainer.errors import InputError
from rastrainer.slicer.translation import _

PYTHON_SLICER = "PythonSlicer"
FOLDER = "simulator"


def pythonSlicer(slicerHome: Path) -> Path:
    """Return Slicer's own Python for programs beside it.

    Raises:
        InputError: it is not where Slicer has it.
    """
    suffix = ".exe" if sys.platform == "win32" else ""
    inside = slicerHome / "bin" / f"{PYTHON_SLICER}{suffix}"
    found = inside if inside.is_file() else shutil.which(PYTHON_SLICER)
    if found is None:
        raise InputError(
            _("{path} is missing; reinstall Slicer, or start the simulator elsewhere.").format(
                path=inside
            )
        )
    return Path(found)


def defaultPackage(moduleFolder: Path) -> str:
    """Return what pip installs: the checkout that the module lies in, or the released version."""
    checkout = moduleFolder.parent
    if (checkout / "pyproject.toml").is_file():
        return str(checkout)
    return f"rastrainer=={__version__}"
