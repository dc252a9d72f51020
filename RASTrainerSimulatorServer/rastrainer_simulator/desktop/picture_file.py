"""Keep what the window shows as a file."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.views.offscreen import write_png


def save_picture(pixels: np.ndarray, folder: Path) -> Path:
    """Write (height, width, 3) uint8 as a PNG named after the time; return its path.

    Raises:
        InputError: it cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be made: {error.strerror}.") from None
    name = datetime.now().strftime("rastrainer-%Y%m%d-%H%M%S-%f")
    path = folder / f"{name[:-3]}.png"
    write_png(pixels, path)
    return path
