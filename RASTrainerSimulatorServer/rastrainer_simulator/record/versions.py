"""Which programs made a record."""

from __future__ import annotations

import contextlib
import functools
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
        **_of_packages(),
    }


@functools.cache
def _of_packages() -> Mapping[str, str]:
    """Ask once: it looks through folders, and a trial begins within a tick."""
    found = {}
    for package in PACKAGES:
        with contextlib.suppress(metadata.PackageNotFoundError):
            found[package] = metadata.version(package)
    return MappingProxyType(found)
