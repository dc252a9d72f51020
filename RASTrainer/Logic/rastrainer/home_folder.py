"""The user's home folder, which some users of servers and containers do not have."""

from __future__ import annotations

from pathlib import Path

from rastrainer.errors import InputError


def home_folder() -> Path:
    try:
        return Path.home()
    except RuntimeError:
        raise InputError(
            "This user has no home folder: name one in the environment variable HOME "
            "(on Windows, USERPROFILE)."
        ) from None
