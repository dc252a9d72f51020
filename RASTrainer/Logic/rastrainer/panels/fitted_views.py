"""Let Slicer's views show all that is in them; without a main window there are none."""

from __future__ import annotations

import slicer


def fitThreeDViews() -> None:
    """Move the cameras of the 3D views so that all that is visible is seen."""
    if slicer.app.layoutManager() is not None:
        slicer.util.resetThreeDViews()


def fitSliceViews() -> None:
    """Let the slice views show their volumes as a whole, which moves their slices, too."""
    if slicer.app.layoutManager() is not None:
        slicer.util.resetSliceViews()
