"""Whether Python's packages, the trainee's page and 3D Slicer are installed."""

from __future__ import annotations

import importlib
import os
import platform
import re
import shutil
import sys
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.home_folder import home_folder
from rastrainer_simulator.assets import page_folder
from rastrainer_simulator.cli.doctor.check_result import CheckResult, CheckStatus

OLDEST_PYTHON = (3, 10)
MODULES = {
    "aiohttp": "aiohttp",
    "numpy": "numpy",
    "psycopg": "psycopg",
    "pygame-ce": "pygame",
    "python-fcl": "fcl",
    "trimesh": "trimesh",
    "trustme": "trustme",
    "vtk": "vtkmodules.vtkCommonCore",
    "yourdfpy": "yourdfpy",
}
"""Package → a module of it that is imported to check it."""
FASTER = {"fastcrc": "fastcrc", "pin": "pinocchio"}
"""Optional packages, which only make it faster."""


def check_python() -> Iterator[CheckResult]:
    """Report the version of Python, and which packages are missing or broken."""
    version = platform.python_version()
    if sys.version_info[:2] >= OLDEST_PYTHON:
        yield CheckResult("python", CheckStatus.OK, f"Python {version} at {sys.executable}.")
    else:
        least = ".".join(map(str, OLDEST_PYTHON))
        yield CheckResult(
            "python",
            CheckStatus.PROBLEM,
            f"Python {version} is too old.",
            f"Install {least} or newer.",
        )
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    broken = list(_broken(MODULES, CheckStatus.PROBLEM))
    yield from broken
    yield from _broken({} if sys.platform == "win32" else FASTER, CheckStatus.WARNING)
    yield from _kinematics()
    if not broken:
        versions = ", ".join(f"{name} {metadata.version(name)}" for name in sorted(MODULES))
        yield CheckResult("packages", CheckStatus.OK, f"All packages can be loaded: {versions}.")


def _kinematics() -> Iterator[CheckResult]:
    try:
        from rastrainer_simulator.robot.kinematics import kinematics_name

        name = kinematics_name()
    except (ImportError, InputError) as error:
        remedy = "Set RASTRAINER_KINEMATICS=numpy, or unset it and install pin."
        sentence = f"The robot's kinematics cannot be computed: {error}"
        yield CheckResult("kinematics", CheckStatus.PROBLEM, sentence, remedy)
        return
    yield CheckResult("kinematics", CheckStatus.OK, f"{name} computes the robot's kinematics.")


def _broken(modules: dict[str, str], verdict: CheckStatus) -> Iterator[CheckResult]:
    for package, module in modules.items():
        try:
            importlib.import_module(module)
            metadata.version(package)
        except Exception as error:  # a broken library may raise anything
            yield CheckResult(
                "packages",
                verdict,
                f"The package {package} cannot be loaded ({error}).",
                f"Reinstall it: {sys.executable} -m pip install --force-reinstall {package}",
            )


def check_page() -> Iterator[CheckResult]:
    """Look for the built page."""
    folder = page_folder()
    if folder is not None:
        yield CheckResult(
            "page", CheckStatus.OK, f"The page for browsers and headsets is in {folder}."
        )
        return
    sentence = "The page for browsers and headsets is not built; the window needs none."
    yield CheckResult("page", CheckStatus.WARNING, sentence, "Build it: make page")


EXTENSION = "SlicerOpenIGTLink"
HOME_VARIABLE = "SLICER_HOME"
ELSEWHERE = "Nothing is wrong where Slicer runs on another computer, or none is used."
LEAST_VERSION = (5, 10)
GET_SLICER = (
    f"Get 3D Slicer 5.10 or newer from https://download.slicer.org, or set {HOME_VARIABLE} to its "
    "folder."
)
GET_EXTENSION = f"Install {EXTENSION} in Slicer's Extensions Manager and restart Slicer."


def check_slicer(places: tuple[Path, ...] | None = None) -> Iterator[CheckResult]:
    """Look for Slicer in `places`, by default its usual folders."""
    homes = list(_homes(_usual_places() if places is None else places))
    if not homes:
        yield CheckResult(
            "slicer", CheckStatus.WARNING, f"3D Slicer is not found. {ELSEWHERE}", GET_SLICER
        )
        return
    for home in homes:
        yield _judged(home)
    found = next((path for home in homes for path in _extension(home)), None)
    if found is None:
        yield CheckResult(
            "slicer", CheckStatus.WARNING, f"{EXTENSION} is not found.", GET_EXTENSION
        )
    else:
        yield CheckResult("slicer", CheckStatus.OK, f"{EXTENSION} is in {found}.")


def _judged(home: Path) -> CheckResult:
    """Check the version of a Slicer, if its folder's name has one."""
    version = re.search(r"Slicer[- ](\d+)\.(\d+)", str(home))
    if version is None or tuple(map(int, version.groups())) >= LEAST_VERSION:
        return CheckResult("slicer", CheckStatus.OK, f"3D Slicer is in {home}.")
    sentence = f"3D Slicer in {home} is older than the module was made for."
    return CheckResult("slicer", CheckStatus.WARNING, sentence, GET_SLICER)


def _home() -> Path:
    """Return the home folder; "~", where no Slicer is, if there is none."""
    try:
        return home_folder()
    except InputError:
        return Path("~")


def _usual_places() -> tuple[Path, ...]:
    home = _home()
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
    seen: set[Path] = set()
    named = os.environ.get(HOME_VARIABLE)
    on_path = shutil.which("Slicer")
    candidates = [Path(named)] if named else []
    candidates += [Path(on_path).resolve().parent] if on_path else []
    candidates += [path for place in places for path in sorted(place.glob("Slicer*"))]
    for candidate in candidates:
        folder = candidate / "Contents" if candidate.suffix == ".app" else candidate
        program = folder / "MacOS" / "Slicer" if sys.platform == "darwin" else folder / _PROGRAM
        if program.is_file() and folder not in seen:
            seen.add(folder)
            yield folder


def _extension(home: Path) -> Iterator[Path]:
    """Yield the folders of the extension: beside Slicer, or in the user's folder."""
    users = _home() / ".config" / "slicer.org"
    if sys.platform == "win32":
        users = Path(os.environ.get("APPDATA", _home())) / "slicer.org"
    for base in (home / "slicer.org", home / "Extensions", home, users, users.parent / "NA-MIC"):
        yield from sorted(base.glob(f"Extensions-*/{EXTENSION}"))


_PROGRAM = "Slicer.exe" if sys.platform == "win32" else "Slicer"
