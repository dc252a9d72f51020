"""Where the robot, the scenarios and the studies that come with RASTrainer are found."""

from __future__ import annotations

from pathlib import Path

_INSTALLED = Path(__file__).parent / "assets"
_CHECKOUT = Path(__file__).parents[2] / "assets"


def asset_path(*parts: str) -> Path:
    """Return the path of a file or folder that comes with RASTrainer.

    A wheel carries the assets inside the package; a checkout keeps them in its root.
    """
    root = _INSTALLED if _INSTALLED.is_dir() else _CHECKOUT
    return root.joinpath(*parts)
