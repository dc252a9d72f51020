"""Pictures of the documentation in few colors, to keep the repository small."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

GRAYS, COLORS = 86, 170
"""The grays of the MRI, which all count, and the colors of everything else."""
GRAY_WITHIN = 6


def reduce_colors(path: Path) -> None:
    """Write a picture again, with its own palette and without dithering."""
    with Image.open(path) as opened:
        picture = opened.convert("RGB")
    pixels = np.asarray(picture).reshape(-1, 3)
    colored = pixels[np.ptp(pixels, axis=1) > GRAY_WITHIN]
    palette = np.repeat(np.linspace(0, 255, GRAYS).astype(np.uint8), 3).tobytes()
    if len(colored):
        few = Image.fromarray(colored[np.newaxis]).quantize(COLORS, Image.Quantize.FASTOCTREE)
        palette += bytes(few.getpalette() or ())
    table = Image.new("P", (1, 1))
    table.putpalette(palette[: 3 * (GRAYS + COLORS)])
    picture.quantize(palette=table, dither=Image.Dither.NONE).save(path, optimize=True)
