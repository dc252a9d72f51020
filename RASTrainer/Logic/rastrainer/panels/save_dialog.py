"""Asks where a file is to be saved, and gives it its suffix where the user has typed none."""

from __future__ import annotations

from pathlib import Path

import qt
import slicer

from rastrainer.panels.plain_text import toolTip
from rastrainer.slicer.translation import _


def askWhereToSave(caption: str, proposed: str, kind: str) -> Path | None:
    """Return the path of the file to be written; None where the user cancels.

    Args:
        caption: of the dialog.
        proposed: name of the file, whose suffix it is to have.
        kind: filter of the dialog, such as `CSV (*.csv)`.
    """
    chosen = qt.QFileDialog.getSaveFileName(slicer.util.mainWindow(), caption, proposed, kind)
    if not chosen:
        return None
    suffix = Path(proposed).suffix
    if chosen.lower().endswith(suffix):
        return Path(chosen)
    path = Path(chosen + suffix)
    # The dialog has asked only about the name without the suffix.
    question = _("{path} is there already. Replace it?").format(path=path)
    if path.exists() and not slicer.util.confirmYesNoDisplay(toolTip(question), caption):
        return None
    return path
