"""How everything that is laid over the picture looks: colors, type scale, spacing.

Lengths are units: one is a pixel where the window is 1920 × 1080, and grows with the window.
"""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer_simulator.presentation import look

REFERENCE_SIZE = (1920, 1080)
LEAST_SCALE = 0.55

Color = tuple[float, float, float, float]
"""Red, green, blue (sRGB) and opacity, 0 to 1."""


def rgba(code: int, opacity: float = 1.0) -> Color:
    """Return a color from its hexadecimal code, such as 0x102030."""
    red, green, blue = (((code >> shift) & 0xFF) / 255.0 for shift in (16, 8, 0))
    return red, green, blue, opacity


NIGHT = rgba(0x0E1726, 0.94)
GLASS = rgba(0x0E1726, 0.80)
SCRIM = rgba(0x0A1220, 0.25)
ROW = rgba(0xFFFFFF, 0.07)
ROW_HOVER = rgba(0xFFFFFF, 0.14)
FIELD = rgba(0x000000, 0.35)
EDGE = rgba(0xFFFFFF, 0.14)
CAP = rgba(0xFFFFFF, 0.16)
CAP_EDGE = rgba(0xFFFFFF, 0.35)

TEXT = rgba(0xF4F7FB)
TEXT_SOFT = rgba(0xB9C5D6)
TEXT_PALE = rgba(0x8C9BB2)
ACCENT = rgba(0x1F74E8)
ACCENT_EDGE = rgba(0xBFDBFF)

TONES = {tone: rgba(int(code[1:], 16)) for tone, code in look.TONES.items()}
BANNERS = {tone: rgba(int(code[1:], 16), 0.96) for tone, code in look.BANNERS.items()}
CONTACT = rgba(0xE5101C)
NEAR = rgba(0x4AA5FF)
ON_SKIN = rgba(0xA6FF66)
TARGET = rgba(int(look.TARGET_COLOR[1:], 16))
TOOL = rgba(0x8CC8FF)
INSET_EDGE = rgba(0xFFFFFF)


@dataclass(frozen=True)
class TextStyle:
    """A step of the type scale: size and distance of lines in units."""

    size: float
    line: float
    is_bold: bool = False


TITLE = TextStyle(46, 58, is_bold=True)
HEADING = TextStyle(31, 40, is_bold=True)
BODY = TextStyle(27, 38)
STRONG = TextStyle(27, 38, is_bold=True)
SMALL = TextStyle(23, 31)
SMALL_STRONG = TextStyle(23, 31, is_bold=True)

# Every distance is a multiple of the first.
STEP = 8
GAP = 2 * STEP
PAD = 3 * STEP
MARGIN = 4 * STEP
PANEL_PAD = 7 * STEP
RADIUS = 2 * STEP
PANEL_RADIUS = 4 * STEP
ROW_HEIGHT = 8 * STEP
MENU_LEFT = 12 * STEP
PANEL_WIDTH = 900
BROAD_PANEL_WIDTH = 1200
WIDE_PANEL_WIDTH = 1560
INSTRUCTION_WIDTH = 940
INSET_SHARE = 0.22


def scale_of(width: int, height: int) -> float:
    """Return how many pixels a unit has in a window of so many pixels."""
    return max(LEAST_SCALE, min(width / REFERENCE_SIZE[0], height / REFERENCE_SIZE[1]))
