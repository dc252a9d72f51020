"""Draw the module's icon: a pointer on an orange arm touches a fiducial on a head.

python assets/icons/make_icon.py      writes RASTrainer/Resources/Icons/RASTrainer.png
"""

import math
from pathlib import Path

from PIL import Image, ImageDraw

ICON = Path(__file__).parents[2] / "RASTrainer" / "Resources" / "Icons" / "RASTrainer.png"
SIZE = 128
SCALE = 8
"""Drawn eight times as large and scaled down, so that edges are smooth."""

NIGHT = (24, 44, 74, 255)
SKIN = (240, 206, 180, 255)
ORANGE = (240, 120, 30, 255)
STEEL = (205, 214, 224, 255)
TOUCHED = (60, 190, 110, 255)
NEXT = (220, 50, 60, 255)

# Units of the 128-pixel icon, y down: a face that looks to the left.
HEAD = (
    [(62, 118), (62, 102), (50, 102), (46, 96), (47, 88), (44, 85), (46, 80), (38, 75)]
    + [(46, 60), (46, 50)]
    + [
        (82 + 36 * math.cos(math.radians(angle)), 50 + 34 * math.sin(math.radians(angle)))
        for angle in range(180, 381, 5)
    ]
    + [(112, 82), (104, 96), (104, 118)]
)
ARM = [(14, 116), (14, 74), (34, 34)]
TIP = (59, 26)
FIDUCIALS = [(82, 18, TOUCHED), (104, 30, TOUCHED), (59, 26, NEXT)]


def main() -> None:
    """Draw the icon and write it."""
    image = Image.new("RGBA", (SIZE * SCALE, SIZE * SCALE), (0, 0, 0, 0))
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle(scaled([(2, 2), (126, 126)]), radius=22 * SCALE, fill=NIGHT)
    draw.polygon(scaled(HEAD), fill=SKIN)
    for x, y, color in FIDUCIALS:
        disk(draw, (x, y), 7.5, (255, 255, 255, 255))
        disk(draw, (x, y), 5.5, color)
    draw.line(scaled([ARM[-1], TIP]), fill=STEEL, width=5 * SCALE)
    draw.line(scaled(ARM), fill=ORANGE, width=14 * SCALE, joint="curve")
    for joint in ARM:
        disk(draw, joint, 9, ORANGE)
        disk(draw, joint, 4, STEEL)
    ICON.parent.mkdir(parents=True, exist_ok=True)
    image.resize((SIZE, SIZE), Image.Resampling.LANCZOS).save(ICON, optimize=True)


def scaled(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return points of the icon in pixels of the large drawing."""
    return [(x * SCALE, y * SCALE) for x, y in points]


def disk(draw: ImageDraw.ImageDraw, center: tuple[float, float], radius: float, color) -> None:
    x, y = center
    corners = [(x - radius, y - radius), (x + radius, y + radius)]
    draw.ellipse(scaled(corners), fill=color)


if __name__ == "__main__":
    main()
