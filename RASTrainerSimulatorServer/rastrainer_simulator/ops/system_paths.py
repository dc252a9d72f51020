"""Where each operating system has settings, logs, and a font with Chinese characters."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from functools import lru_cache
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


CHINESE = "zh-Hans"
_WINDOWS = ("msyh.ttc", "msyh.ttf", "simhei.ttf", "simsun.ttc")
_MACOS = ("Hiragino Sans GB.ttc", "STHeiti Light.ttc", "PingFang.ttc")
_ASK_FONTCONFIG = ("fc-match", "--format", "%{file}\n%{lang}", ":lang=zh-cn")
_LONGEST_ANSWER_S = 60.0
"""Fontconfig's first answer may wait until it has read every font."""


@lru_cache(maxsize=1)
def chinese_font() -> Path | None:
    """Return a font with Chinese characters, which the window's own fonts lack; None without one.

    Its first face is used.
    """
    if sys.platform == "win32":
        fonts = Path(os.environ.get("WINDIR", r"C:\Windows")) / "Fonts"
        return _first(fonts / name for name in _WINDOWS)
    if sys.platform == "darwin":
        return _first(Path("/System/Library/Fonts") / name for name in _MACOS)
    return _font_of_fontconfig()


def has_letters(language: str) -> bool:
    """Return whether the window has the letters of a language (BCP 47 tag) here."""
    return language != CHINESE or chinese_font() is not None


def _first(paths: Iterable[Path]) -> Path | None:
    return next((path for path in paths if path.is_file()), None)


def _font_of_fontconfig() -> Path | None:
    """Return fontconfig's choice; without one for Chinese it chooses another language's."""
    if shutil.which(_ASK_FONTCONFIG[0]) is None:
        return None
    try:
        answer = subprocess.run(
            _ASK_FONTCONFIG, capture_output=True, text=True, timeout=_LONGEST_ANSWER_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    name, _, languages = answer.stdout.partition("\n")
    path = Path(name)
    return path if "zh-cn" in languages.split("|") and path.is_file() else None
