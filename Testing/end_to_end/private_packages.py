"""A private folder as a set-up from Slicer leaves it, made of this Python's own packages."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from rastrainer.python_environment import private_command
from rastrainer.slicer.program.simulator_package import LOCK, SimulatorPackage
from rastrainer.slicer.program.trim_packages import SIZES

ROOT = Path(__file__).parents[2]
SIMULATOR, TRIMMER = "rastrainer_simulator.cli.main", "rastrainer.slicer.program.trim_packages"


def fill(folder: Path, wheel: Path) -> None:
    """Put the wheel and what the simulator's lock names into a folder, as pip would.

    Files of this Python's packages are linked, not copied; removing one removes the link.
    """
    words = ["--no-deps", "--no-index", "--no-cache-dir", "-q", "--target", str(folder)]
    subprocess.run([sys.executable, "-m", "pip", "install", *words, str(wheel)], check=True)
    for name in _locked_names():
        try:
            found = distribution(name)
        except PackageNotFoundError:
            continue  # For another platform or version of Python.
        root = Path(found.locate_file(""))
        for file in found.files:
            source = Path(found.locate_file(file)).resolve()
            if source.is_file() and source.is_relative_to(root):
                _link(source, folder / source.relative_to(root))


def trim(folder: Path) -> tuple[dict[str, int], str]:
    """Trim a folder as a set-up does; return the sizes that it notes, and its output."""
    command = private_command(Path(sys.executable), folder, TRIMMER, str(folder))
    done = subprocess.run(command, capture_output=True, text=True, env=without_packages())
    assert done.returncode == 0, done.stderr
    return json.loads((folder / SIZES).read_text(encoding="utf-8")), done.stdout


def run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run `rastrainer` on the packages of the folder alone."""
    command = private_command(Path(sys.executable), folder, SIMULATOR, *words)
    return subprocess.run(command, capture_output=True, text=True, env=without_packages())


def without_packages() -> dict[str, str]:
    """Return this environment without packages from elsewhere."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def _locked_names() -> list[str]:
    lock = SimulatorPackage.of(ROOT / "RASTrainer").folder / LOCK
    names = re.findall(r"^([a-z0-9._-]+)==", lock.read_text(encoding="utf-8"), re.MULTILINE)
    return sorted(set(names))


def _link(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.exists():
        return
    try:
        os.link(source, target)
    except OSError:
        shutil.copy(source, target)  # On another disk.
