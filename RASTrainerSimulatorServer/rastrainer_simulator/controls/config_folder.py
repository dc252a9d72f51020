"""Where the user's settings are kept."""

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
