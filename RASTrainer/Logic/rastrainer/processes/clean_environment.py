"""The environment as it was before Slicer's launcher: for programs that are not Slicer's.

The launchers of Slicer and of its Python put Slicer's own folders before all others, for whatever
they start, and for whatever that starts. A program that has packages of its own would load Slicer's
Qt, VTK or numpy in their place.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

LEVEL = "APPLAUNCHER_LEVEL"
SAVED = "APPLAUNCHER_0_"
"""Before the name of a variable: its value before the first launcher."""
HOME = "SLICER_HOME"
SEARCHED = {
    "LD_LIBRARY_PATH": "shared libraries, on Linux",
    "DYLD_LIBRARY_PATH": "shared libraries, on macOS",
    "DYLD_FRAMEWORK_PATH": "shared libraries, on macOS",
    "LibraryPaths": "shared libraries, on Windows",
    "PYTHONPATH": "packages of Python",
    "PYTHONHOME": "the standard library of Python",
    "PYTHONNOUSERSITE": "whether the user's own packages count",
    "PYTHONUTF8": "how Python reads text",
    "QT_PLUGIN_PATH": "plugins of Qt",
    "QT_QPA_PLATFORM_PLUGIN_PATH": "plugins of Qt",
    "QML_IMPORT_PATH": "plugins of Qt",
    "QML2_IMPORT_PATH": "plugins of Qt",
    "QTWEBENGINE_DISABLE_SANDBOX": "how Qt shows pages",
    "ITK_AUTOLOAD_PATH": "plugins of ITK",
    "SSL_CERT_FILE": "certificates, which Slicer brings along",
    "PIP_REQUIRE_VIRTUALENV": "how pip behaves",
    HOME: "Slicer itself",
}
"""What Slicer's launchers set, and what is looked for there."""


def clean_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment as Slicer's launchers found it; one without them stays as it is.

    What the user had set in the variables of `SEARCHED` and in PATH comes back where the launchers
    have saved it.
    """
    if LEVEL not in environment and HOME not in environment:
        return dict(environment)
    # Windows has the names in capitals.
    searched = {name.upper() for name in SEARCHED}
    clean = {
        name: value
        for name, value in environment.items()
        if name.upper() not in searched and not name.startswith("APPLAUNCHER_")
    }
    clean["PATH"] = _without(clean.get("PATH", os.defpath), environment.get(HOME, ""))
    for name in (*SEARCHED, "PATH"):
        if SAVED + name in environment:
            clean[name] = environment[SAVED + name]
    return clean


def _without(path: str, home: str) -> str:
    """Return a search path without the folders in Slicer's."""
    if not home:
        return path
    inside = Path(home).resolve()
    places = path.split(os.pathsep)
    kept = [place for place in places if not Path(place).resolve().is_relative_to(inside)]
    return os.pathsep.join(kept)
