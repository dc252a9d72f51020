"""Remove folders of thousands of files without keeping Slicer waiting."""

from __future__ import annotations

import shutil
import threading
import uuid
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.slicer.translation import _

MARK = ".removed-"
"""In the name of a folder that is being removed."""


def discard(folder: Path) -> None:
    """Remove a folder: at once from its place, and soon from the disk; none is no error.

    Raises:
        InputError: something in it is in use, or it is not ours to remove.
    """
    if not folder.exists():
        return
    aside = folder.with_name(f"{folder.name}{MARK}{uuid.uuid4().hex}")
    try:
        folder.rename(aside)
    except OSError as error:
        raise InputError(
            _("The folder {path} cannot be removed: {reason}.").format(
                path=folder, reason=error.strerror
            )
        ) from None
    _remove([aside])


def discardLeftovers(folder: Path) -> None:
    """Remove what an earlier removal of this folder has left, as Slicer had quit meanwhile."""
    _remove(list(folder.parent.glob(f"{folder.name}*{MARK}*")))


def _remove(folders: list[Path]) -> None:
    def work() -> None:
        for path in folders:
            shutil.rmtree(path, ignore_errors=True)

    threading.Thread(target=work, daemon=True).start()
