"""Whether 3D Slicer is on this computer, and with it the extension that carries the link."""

from __future__ import annotations

import os
import re
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from rastrainer_simulator.doctor.finding import Finding, Verdict

EXTENSION = "SlicerOpenIGTLink"
HOME_VARIABLE = "SLICER_HOME"
ELSEWHERE = "Nothing is wrong where Slicer runs on another computer, or none is used."
LEAST_VERSION = (5, 10)
GET_SLICER = (
    f"Get 3D Slicer 5.10 or newer from https://download.slicer.org, or set {HOME_VARIABLE} to its "
    "folder."
)
GET_EXTENSION = f"Install {EXTENSION} in Slicer's Extensions Manager and restart Slicer."


def check_slicer(places: tuple[Path, ...] | None = None) -> Iterator[Finding]:
    """Look for Slicer in `places`, by default where it is usually put."""
    homes = list(_homes(_usual_places() if places is None else places))
    if not homes:
        yield Finding("slicer", Verdict.WARNING, f"3D Slicer is not found. {ELSEWHERE}", GET_SLICER)
        return
    for home in homes:
        yield _judged(home)
    found = next((path for home in homes for path in _extension(home)), None)
    if found is None:
        yield Finding("slicer", Verdict.WARNING, f"{EXTENSION} is not found.", GET_EXTENSION)
    else:
        yield Finding("slicer", Verdict.OK, f"{EXTENSION} is in {found}.")


def _judged(home: Path) -> Finding:
    """Judge a Slicer by its version, where its folder's name tells it."""
    version = re.search(r"Slicer[- ](\d+)\.(\d+)", str(home))
    if version is None or tuple(map(int, version.groups())) >= LEAST_VERSION:
        return Finding("slicer", Verdict.OK, f"3D Slicer is in {home}.")
    told = f"3D Slicer in {home} is older than the module was made for."
    return Finding("slicer", Verdict.WARNING, told, GET_SLICER)


def _usual_places() -> tuple[Path, ...]:
    home = Path.home()
    if sys.platform == "win32":
        names = ("LOCALAPPDATA", "ProgramData", "ProgramFiles")
        bases = [Path(os.environ[name]) for name in names if name in os.environ]
        return tuple(
            place for base in bases for place in (base, base / "slicer.org", base / "NA-MIC")
        )
    if sys.platform == "darwin":
        return Path("/Applications"), home / "Applications"
    return home, home / "Applications", home / "Downloads", Path("/opt"), Path("/usr/local")


def _homes(places: tuple[Path, ...]) -> Iterator[Path]:
    """Yield each folder of a Slicer once."""
    told: set[Path] = set()
    named = os.environ.get(HOME_VARIABLE)
    on_path = shutil.which("Slicer")
    candidates = [Path(named)] if named else []
    candidates += [Path(on_path).resolve().parent] if on_path else []
    candidates += [path for place in places for path in sorted(place.glob("Slicer*"))]
    for candidate in candidates:
        folder = candidate / "Contents" if candidate.suffix == ".app" else candidate
        program = folder / "MacOS" / "Slicer" if sys.platform == "darwin" else folder / _PROGRAM
        if program.is_file() and folder not in told:
            told.add(folder)
            yield folder


def _extension(home: Path) -> Iterator[Path]:
    """Yield where the extension lies: beside Slicer, or in the user's folder."""
    users = Path.home() / ".config" / "slicer.org"
    if sys.platform == "win32":
        users = Path(os.environ.get("APPDATA", Path.home())) / "slicer.org"
    for base in (home / "slicer.org", home / "Extensions", home, users, users.parent / "NA-MIC"):
        yield from sorted(base.glob(f"Extensions-*/{EXTENSION}"))


_PROGRAM = "Slicer.exe" if sys.platform == "win32" else "Slicer"
