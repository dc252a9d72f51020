"""Whether somebody may be looking at what the module shows."""

from __future__ import annotations

from typing import Any

import slicer


def isSomethingSeen(isEntered: bool, inSlices: bool = False) -> bool:
    """Return whether the module is entered or a view shown, in a window that is not minimized.

    The parts of a minimized window still call themselves visible.

    Args:
        isEntered: the module is the one that is chosen.
        inSlices: slice views count as well as 3D views.
    """
    window = slicer.util.mainWindow()
    if window is not None and window.minimized:
        return False
    layoutManager = slicer.app.layoutManager()
    if isEntered or layoutManager is None:
        return isEntered
    return _is3DViewShown(layoutManager) or (inSlices and _isSliceViewShown(layoutManager))


def _is3DViewShown(layoutManager: Any) -> bool:
    count = layoutManager.threeDViewCount
    return any(layoutManager.threeDWidget(index).visible for index in range(count))


def _isSliceViewShown(layoutManager: Any) -> bool:
    names = layoutManager.sliceViewNames()
    return any(layoutManager.sliceWidget(name).visible for name in names)
