"""How well the machine draws: the quality that it can afford, and the pictures that it dropped."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum

SOFTWARE_RENDERERS = (
    "llvmpipe",
    "softpipe",
    "swrast",
    "swr",
    "swiftshader",
    "software",
    "microsoft basic render",
    "gdi generic",
)
SLOWEST_FRAME_S = 1.0 / 45.0
SOFTWARE_SIZE = (1280, 720)
"""A processor of two cores draws 20 pictures a second of this size; docs/design.md has numbers."""


class Quality(str, Enum):
    """What a picture is made of.

    High has physically based light, soft shadows, shaded corners and smooth edges; medium leaves
    shadows and shaded corners out; low is plain light, and in large windows a fraction of the
    resolution, for machines without a graphics processor.
    """

    HIGH = "high"
    MEDIUM = "medium"
    LOW = "low"

    @property
    def is_physical(self) -> bool:
        """Whether surfaces are physically based."""
        return self is not Quality.LOW

    @property
    def next_lower(self) -> Quality:
        """The next quality that costs less."""
        return Quality.MEDIUM if self is Quality.HIGH else Quality.LOW


def first_quality(renderer_name: str) -> Quality:
    """Return what to begin with, by OpenGL's name of the renderer."""
    name = renderer_name.lower()
    is_software = any(known in name for known in SOFTWARE_RENDERERS)
    return Quality.LOW if is_software else Quality.HIGH


SECOND = 1.0


class FrameCount:
    """Counts the pictures of each second, and those that were due and did not come."""

    def __init__(self, report: Callable[[int, int], None], now: float):
        """`report` is called once a second with how many were shown and how many dropped."""
        self._on_second = report
        self._since = now
        self._shown = self._due = 0

    def due(self) -> None:
        """Something to be drawn has arrived."""
        self._due += 1

    def shown(self) -> None:
        """A picture with all that has arrived was drawn."""
        self._shown += 1

    def report(self, now: float) -> None:
        """Report if a second is over."""
        if now - self._since >= SECOND:
            self._on_second(self._shown, max(0, self._due - self._shown))
            self._since, self._shown, self._due = now, 0, 0
