"""A home of its own for the user: tests must never touch the studies of whoever runs them."""

from __future__ import annotations

import os
from pathlib import Path

from PySide6.QtCore import QStandardPaths

VARIABLES = ("HOME", "USERPROFILE", "APPDATA", "LOCALAPPDATA")
WITHOUT = ("XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DOCUMENTS_DIR")


class Home:
    """Everything that Qt calls the user's lies in `folder`, until `leave`."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._former = {name: os.environ.get(name) for name in (*VARIABLES, *WITHOUT)}
        for name in VARIABLES:
            os.environ[name] = str(folder)
        for name in WITHOUT:
            os.environ.pop(name, None)
        QStandardPaths.setTestModeEnabled(True)

    def leave(self) -> None:
        """Restore what was there."""
        for name, value in self._former.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
