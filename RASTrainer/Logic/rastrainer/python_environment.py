"""The environment in which a child process runs, free of Slicer's own packages.

The launchers of Slicer and of its Python put Slicer's folders first in every search path of the
programs they start. A program with its own packages would load Slicer's Qt, VTK or numpy.
`clean_environment` restores the environment as it was before the launchers.

The simulator runs on the packages of one folder, filled by `pip install --target`. Slicer's Python
would search Slicer's packages first, and `.pth` files of a folder on PYTHONPATH are not read, which
Pinocchio needs. So the program and its child processes are started by `python_command`, and `run`
sets their search path.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import runpy
import site
import sys
import uuid
from collections.abc import Iterator, Mapping
from pathlib import Path

LEVEL = "APPLAUNCHER_LEVEL"
SAVED = "APPLAUNCHER_0_"
"""Before the name of a variable: its value before the first launcher."""
HOME = "SLICER_HOME"
SEARCHED = (
    *("LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FRAMEWORK_PATH", "LibraryPaths"),
    *("PYTHONPATH", "PYTHONHOME", "PYTHONNOUSERSITE", "PYTHONUTF8"),
    *("QT_PLUGIN_PATH", "QT_QPA_PLATFORM_PLUGIN_PATH", "QML_IMPORT_PATH", "QML2_IMPORT_PATH"),
    *("QTWEBENGINE_DISABLE_SANDBOX", "ITK_AUTOLOAD_PATH", "SSL_CERT_FILE"),
    *("PIP_REQUIRE_VIRTUALENV", HOME),
)
"""The variables that Slicer's launchers set."""


def clean_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment as Slicer's launchers found it; without them it is unchanged.

    The user's own values of PATH and of the variables in `SEARCHED` come back if the launchers
    saved them.
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
    clean["PATH"] = clean.get("PATH", os.defpath)
    if environment.get(HOME):
        # The folders in Slicer's own are left out.
        slicer = Path(environment[HOME]).resolve()
        places = clean["PATH"].split(os.pathsep)
        kept = [place for place in places if not Path(place).resolve().is_relative_to(slicer)]
        clean["PATH"] = os.pathsep.join(kept)
    for name in (*SEARCHED, "PATH"):
        if SAVED + name in environment:
            clean[name] = environment[SAVED + name]
    return clean


@contextlib.contextmanager
def temporary_environment(values: Mapping[str, str]) -> Iterator[None]:
    """Set variables temporarily: programs that are started later must not inherit them."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


START = (
    "import site, sys; sys.path.insert(0, sys.argv[1]); site.addsitedir(sys.argv[1]); "
    "from rastrainer.python_environment import run; run()"
)
"""For `python -S -c`, followed by the folder, a module's name and the program's arguments.

A `.pth` file of the folder may say where our own package is: in a checkout.
"""
LIBRARIES = "python-libraries"
"""Folder of links, in the private one: to shared libraries that Python itself needs."""

_LINKED_MODULES = ("_bz2", "_ctypes", "_hashlib", "_lzma", "_sqlite3", "_ssl", "_uuid", "zlib")
"""Modules of the standard library that need shared libraries."""
_LOADER_VARIABLES = ("LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH", "DYLD_FRAMEWORK_PATH")
_MAPS = Path("/proc/self/maps")

_folder: Path | None = None


def python_command(module: str, *words: str) -> list[str]:
    """Return what starts a module as a program, by this Python and on the packages of this one."""
    if _folder is None:
        return [sys.executable, "-m", module, *words]
    return private_command(Path(sys.executable), _folder, module, *words)


def private_command(python: Path, folder: Path, module: str, *words: str) -> list[str]:
    return [str(python), "-S", "-c", START, str(folder), module, *words]


def run() -> None:
    """Run the program that `private_command` names; it never returns."""
    global _folder
    _command, folder, module, *words = sys.argv
    environment = _own_environment(Path(folder))
    loader = [name for name in _LOADER_VARIABLES if environment.get(name) != os.environ.get(name)]
    if loader and os.name == "posix":
        # The loader has read its variables already: only a new process sees the change.
        arguments = private_command(Path(sys.executable), Path(folder), module, *words)
        os.execve(sys.executable, arguments, environment)
    given = [place for place in os.environ.get("PYTHONPATH", "").split(os.pathsep) if place]
    os.environ.clear()
    os.environ.update(environment)
    # Python puts the folders of PYTHONPATH first; the standard library's may be one of them.
    sys.path[:] = [place for place in sys.path if place not in ("", folder)][len(given) :]
    site.addsitedir(folder)
    _folder = Path(folder)
    sys.argv = [module, *words]
    runpy.run_module(module, run_name="__main__", alter_sys=True)
    sys.exit(0)


def _own_environment(folder: Path) -> dict[str, str]:
    """Return the environment for this Python and its child processes, without Slicer's folders."""
    clean = clean_environment(os.environ)
    clean.pop("PYTHONPATH", None)
    # Slicer's Python lies in another folder than its standard library.
    if "PYTHONHOME" in os.environ:
        clean["PYTHONHOME"] = os.environ["PYTHONHOME"]
    wanted = clean.get("LD_LIBRARY_PATH", "")
    if os.environ.get("LD_LIBRARY_PATH", "") != wanted:
        links, libraries = folder / LIBRARIES, python_libraries(os.environ)
        if libraries:
            links.mkdir(exist_ok=True)
        for name, path in libraries.items():
            if os.path.realpath(links / name) != str(path):
                # Another simulator may be starting at this moment.
                partial = links / f".{uuid.uuid4().hex}"
                partial.symlink_to(path)
                partial.replace(links / name)
        places = [str(links) if libraries else "", wanted]
        clean["LD_LIBRARY_PATH"] = os.pathsep.join(filter(None, places))
    return clean


def python_libraries(environment: Mapping[str, str]) -> dict[str, Path]:
    """Return, by their names, shared libraries of this Python that LD_LIBRARY_PATH leads to.

    Slicer's Python finds its own OpenSSL only by it, in a folder with all of Slicer's libraries.
    """
    for name in _LINKED_MODULES:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    mapped = {os.path.realpath(path) for path in mapped_files()}
    found: dict[str, Path] = {}
    for place in filter(None, environment.get("LD_LIBRARY_PATH", "").split(os.pathsep)):
        with contextlib.suppress(OSError):
            for path in sorted(Path(place).iterdir()):
                if os.path.realpath(path) in mapped:
                    found.setdefault(path.name, Path(os.path.realpath(path)))
    return found


def mapped_files() -> list[str]:
    """Return the files that this process has loaded, on Linux; elsewhere none."""
    if not _MAPS.exists():
        return []
    lines = _MAPS.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    return [line.split(None, 5)[5] for line in lines if "/" in line]
