"""Pictures that were saved as files, for the tests to inspect."""

from pathlib import Path

import numpy as np
from PIL import Image


def read_png(path: Path) -> np.ndarray:
    """Return (height, width, 3) uint8, the top row first."""
    return np.asarray(Image.open(path).convert("RGB"))
