"""How much light and shadow the machine can afford."""

from __future__ import annotations

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


class Quality(str, Enum):
    """What a picture is made of.

    High has physically based light, soft shadows, shaded corners and smooth edges; medium leaves
    shadows and shaded corners out; low is plain light, for machines without a graphics processor.
    """

    HIGH = "high"
    MEDIUM = "medium"
    LOW = "low"

    @property
    def is_physical(self) -> bool:
        """Whether surfaces are physically based."""
        return self is not Quality.LOW

    @property
    def lower(self) -> Quality:
        """The next quality that costs less."""
        return Quality.MEDIUM if self is Quality.HIGH else Quality.LOW


AUTOMATIC = "auto"


def first_quality(renderer_name: str) -> Quality:
    """Return what to begin with, by OpenGL's name of the renderer."""
    name = renderer_name.lower()
    is_software = any(known in name for known in SOFTWARE_RENDERERS)
    return Quality.LOW if is_software else Quality.HIGH
