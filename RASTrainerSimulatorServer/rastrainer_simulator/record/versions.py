"""Which programs made a record."""

from __future__ import annotations

import contextlib
import platform
from collections.abc import Mapping
from importlib import metadata
from types import MappingProxyType

import rastrainer
from rastrainer.protocol import PROTOCOL_VERSION

PACKAGES = ("numpy", "pin", "python-fcl")


def versions() -> dict[str, str]:
    """Return name and version of what a trajectory depends on; a missing package is left out."""
    return {
        "rastrainer": rastrainer.__version__,
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        **_OF_PACKAGES,
    }


def _of_packages() -> Mapping[str, str]:
    found = {}
    for package in PACKAGES:
        with contextlib.suppress(metadata.PackageNotFoundError):
            found[package] = metadata.version(package)
    return MappingProxyType(found)


# Looked up at once: that goes through folders, and a trial begins within a tick.
_OF_PACKAGES = _of_packages()
