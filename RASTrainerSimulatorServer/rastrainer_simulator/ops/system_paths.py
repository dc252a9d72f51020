"""Where each operating system has settings, logs and caches."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from rastrainer.home_folder import home_folder


def config_folder() -> Path:
    """Return the user's folder of RASTrainer's settings; it need not exist."""
    mac = "", "Library/Application Support", "RASTrainer"
    others = "XDG_CONFIG_HOME", ".config", "rastrainer"
    return _folder(("APPDATA", "AppData/Roaming", "RASTrainer"), mac, others)


def log_folder() -> Path:
    """Return the user's folder of RASTrainer's logs; it need not exist."""
    mac = "", "Library/Logs", "RASTrainer"
    others = "XDG_STATE_HOME", ".local/state", "rastrainer/logs"
    return _folder(("LOCALAPPDATA", "AppData/Local", "RASTrainer/Logs"), mac, others)


def cache_folder() -> Path:
    """Return the user's folder for what RASTrainer can build again; it need not exist."""
    mac = "", "Library/Caches", "rastrainer"
    others = "XDG_CACHE_HOME", ".cache", "rastrainer"
    return _folder(("LOCALAPPDATA", "AppData/Local", "rastrainer"), mac, others)


def _folder(*places: tuple[str, str, str]) -> Path:
    """Return the folder in Windows, in macOS or elsewhere.

    Each place is the variable with the folder's parent, its usual parent at home, and its name.
    """
    variable, usual, name = places[{"win32": 0, "darwin": 1}.get(sys.platform, 2)]
    return Path(os.environ.get(variable) or home_folder() / usual) / name
