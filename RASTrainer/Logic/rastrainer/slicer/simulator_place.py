"""Which Python and which package set the simulator up, and where its private folder is."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from rastrainer import __version__

PYTHON_SLICER = "PythonSlicer"


def pythonSlicer(slicerHome: Path) -> Path:
    """Return Slicer's own Python for programs beside it, where Slicer has it or on the PATH."""
    suffix = ".exe" if sys.platform == "win32" else ""
    inside = slicerHome / "bin" / f"{PYTHON_SLICER}{suffix}"
    found = None if inside.is_file() else shutil.which(PYTHON_SLICER)
    return Path(found) if found else inside


def defaultPackage(moduleFolder: Path) -> str:
    """Return what pip installs: the checkout that the module lies in, or the released version."""
    checkout = moduleFolder.parent
    if (checkout / "pyproject.toml").is_file():
        return str(checkout)
    return f"rastrainer=={__version__}"
