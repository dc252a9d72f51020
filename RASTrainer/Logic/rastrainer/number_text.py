"""Numbers as people read them: halves rounded up, a true minus sign."""

from __future__ import annotations


def fixed(value: float, digits: int) -> str:
    """Return a number with so many digits after the point."""
    return f"{_past_half(value):.{digits}f}".replace("-", "−")


def significant(value: float, digits: int = 3, sign: bool = False) -> str:
    """Return a number with so many significant digits, with its sign even where that is +."""
    return f"{_past_half(value):{'+' if sign else ''}.{digits}g}".replace("-", "−")


def percent(share: float) -> str:
    """Return a share as whole percent."""
    return f"{100 * share:.0f} %"


def _past_half(value: float) -> float:
    """Return the number a trifle farther from 0: 0.1465, stored as 0.14649…, becomes 0.147."""
    return value * (1 + 1e-12)
