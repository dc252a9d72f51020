"""The folders of the user's settings and logs."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def config_folder() -> Path:
    """Return the user's folder of RASTrainer's settings; it need not exist."""
    if sys.platform == "win32":
        base = os.environ.get("APPDATA")
        return Path(base or Path.home() / "AppData" / "Roaming") / "RASTrainer"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Application Support" / "RASTrainer"
    base = os.environ.get("XDG_CONFIG_HOME")
    return Path(base or Path.home() / ".config") / "rastrainer"


def log_folder() -> Path:
    """Return the user's folder of RASTrainer's logs; it need not exist."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
        return Path(base or Path.home() / "AppData" / "Local") / "RASTrainer" / "Logs"
    if sys.platform == "darwin":
        return Path.home() / "Library" / "Logs" / "RASTrainer"
    base = os.environ.get("XDG_STATE_HOME")
    return Path(base or Path.home() / ".local" / "state") / "rastrainer" / "logs"
