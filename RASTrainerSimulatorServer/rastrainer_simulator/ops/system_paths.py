"""Where each operating system has settings and logs."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from rastrainer.home_folder import home_folder


def config_folder() -> Path:
    """Return the user's folder of RASTrainer's settings; it need not exist."""
    if sys.platform == "win32":
        base = os.environ.get("APPDATA")
        return Path(base or home_folder() / "AppData" / "Roaming") / "RASTrainer"
    if sys.platform == "darwin":
        return home_folder() / "Library" / "Application Support" / "RASTrainer"
    base = os.environ.get("XDG_CONFIG_HOME")
    return Path(base or home_folder() / ".config") / "rastrainer"


def log_folder() -> Path:
    """Return the user's folder of RASTrainer's logs; it need not exist."""
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
        return Path(base or home_folder() / "AppData" / "Local") / "RASTrainer" / "Logs"
    if sys.platform == "darwin":
        return home_folder() / "Library" / "Logs" / "RASTrainer"
    base = os.environ.get("XDG_STATE_HOME")
    return Path(base or home_folder() / ".local" / "state") / "rastrainer" / "logs"
