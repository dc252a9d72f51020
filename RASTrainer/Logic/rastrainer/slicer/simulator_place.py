"""Which Python sets the simulator up and runs it."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

PYTHON_SLICER = "PythonSlicer"


def pythonSlicer(slicerHome: Path) -> Path:
    """Return Slicer's own Python for programs beside it, where Slicer has it or on the PATH."""
    suffix = ".exe" if sys.platform == "win32" else ""
    inside = slicerHome / "bin" / f"{PYTHON_SLICER}{suffix}"
    found = None if inside.is_file() else shutil.which(PYTHON_SLICER)
    return Path(found) if found else inside
