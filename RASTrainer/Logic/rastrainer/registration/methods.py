"""How a head is registered: what is touched or traced on it."""

from __future__ import annotations

from enum import Enum


class RegistrationMethod(str, Enum):
    """A way of registering a head."""

    FIDUCIALS = "fiducials"
    LANDMARKS = "landmarks"
    SURFACE = "surface"
    SCAN = "scan"
    BONE_SCREWS = "bone-screws"
    LANDMARKS_SURFACE = "landmarks-surface"
