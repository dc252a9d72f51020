"""Where files are kept that can be made again."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
from pathlib import Path

KEPT_FILES = 60


def cache_folder() -> Path:
    """Return the user's cache folder for scenes, made if need be; a passing one if it cannot."""
    folder = _users_caches() / "rastrainer" / "scenes"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / ".writable").touch()
    except OSError:
        return Path(tempfile.mkdtemp(prefix="rastrainer-scenes-"))
    return folder


def forget_oldest(folder: Path) -> None:
    """Delete scenes beyond the newest ones, and what a crash left half written."""
    with contextlib.suppress(OSError):
        files = [path for path in folder.iterdir() if path.suffix in (".glb", ".partial")]
        files.sort(key=lambda path: path.stat().st_mtime, reverse=True)
        for path in files[KEPT_FILES:]:
            path.unlink(missing_ok=True)


def _users_caches() -> Path:
    if sys.platform == "win32":
        return Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Caches"
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
