"""Measure what setting the simulator up from Slicer downloads and keeps, for each platform.

    python tools/measure_simulator.py

Downloads the wheels of the simulator's lock for the Python of Slicer, once a platform, and adds up
their sizes. The size after trimming is measured by installing, so only for the platform this runs
on; elsewhere it is the content of the wheels, less the files that are never opened. Writes
RASTrainer/Resources/RASTrainerSimulator/sizes.json, which the module shows.
"""

import json
import platform
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path

from pip._vendor.packaging.markers import Marker

ROOT = Path(__file__).resolve().parents[1]
RESOURCES = ROOT / "RASTrainer" / "Resources" / "RASTrainerSimulator"
LOCK = RESOURCES / "requirements.lock"
SIZES = RESOURCES / "sizes.json"
SLICERS_PYTHON = "3.12"
LINUX_TAGS = tuple(f"manylinux_2_{minor}" for minor in (17, 24, 26, 27, 28, 31, 34))
PLATFORMS = {
    "linux-x86_64": tuple(f"{tag}_x86_64" for tag in ("manylinux2014", *LINUX_TAGS)),
    "darwin-arm64": ("macosx_14_0_arm64",),
    "darwin-x86_64": ("macosx_14_0_x86_64",),
    "win32-AMD64": ("win_amd64",),
}
MEGABYTE = 10**6
SOURCES = (ROOT / "RASTrainer" / "Logic", ROOT / "RASTrainerSimulatorServer")
sys.path.insert(0, str(SOURCES[0]))
from rastrainer.python_environment import private_command  # noqa: E402 (the checkout's own)
from rastrainer.slicer.program import trim_packages  # noqa: E402 (the checkout's own)


def requirements(system: str, machine: str) -> str:
    """Return the entries of the lock that hold on a platform, hashes included."""
    environment = {
        "sys_platform": system,
        "platform_machine": machine,
        "python_version": SLICERS_PYTHON,
        "python_full_version": f"{SLICERS_PYTHON}.10",
        "platform_python_implementation": "CPython",
        "implementation_name": "cpython",
    }
    kept, holds = [], False
    for line in LOCK.read_text(encoding="utf-8").splitlines(keepends=True):
        if not line.startswith(" "):
            requirement, _semicolon, marker = line.rstrip(" \\\n").partition(" ; ")
            holds = not marker or Marker(marker).evaluate(environment)
            line = f"{requirement} \\\n"
        kept += [line] if holds else []
    return "".join(kept)


def measure(system: str, machine: str, tags: Sequence[str]) -> dict[str, int]:
    """Return the megabytes of the wheels and of their files, less those never opened."""
    with tempfile.TemporaryDirectory() as temporary:
        lock = Path(temporary, "requirements.lock")
        lock.write_text(requirements(system, machine), encoding="utf-8")
        words = ["--no-deps", "--require-hashes", "--only-binary=:all:", "--no-cache-dir", "-q"]
        words += ["--python-version", SLICERS_PYTHON, "--dest", temporary]
        words += [word for tag in tags for word in ("--platform", tag)]
        command = [sys.executable, "-m", "pip", "download", *words, "-r", str(lock)]
        subprocess.run(command, check=True)
        wheels = list(Path(temporary).glob("*.whl"))
        download = sum(wheel.stat().st_size for wheel in wheels)
        kept = sum(_kept(wheel) for wheel in wheels)
        return {"downloadMB": round(download / MEGABYTE), "keptMB": round(kept / MEGABYTE)}


def _kept(wheel: Path) -> int:
    kept = 0
    with zipfile.ZipFile(wheel) as archive:
        for file in archive.infolist():
            # Files that pip puts next to the packages are below `….data/purelib` or `platlib`.
            inside = file.filename.split(".data/purelib/")[-1].split(".data/platlib/")[-1]
            never = any(inside.startswith(f"{folder}/") for folder in trim_packages.NEVER_OPENED)
            never = never or trim_packages.TESTS in Path(inside).parts[:-1]
            if not never and not any(fnmatch(inside, form) for form in trim_packages.BUILDING_ONLY):
                kept += file.file_size
    return kept


def measure_here() -> int:
    """Return the megabytes that stay when the packages are installed and trimmed here."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary, "simulator")
        words = ["--no-deps", "--require-hashes", "--only-binary=:all:", "--no-cache-dir", "-q"]
        command = [sys.executable, "-m", "pip", "install", *words, "-r", str(LOCK)]
        subprocess.run([*command, "--target", str(folder)], check=True)
        (folder / "rastrainer.pth").write_text("\n".join(map(str, SOURCES)), encoding="utf-8")
        trimmer = ("rastrainer.slicer.program.trim_packages", str(folder))
        python = Path(sys.executable)
        subprocess.run(private_command(python, folder, *trimmer), check=True)
        return round(trim_packages.size(folder) / MEGABYTE)


def main() -> None:
    """Measure all, and write the file."""
    sizes = {name: measure(*name.split("-"), tags) for name, tags in PLATFORMS.items()}
    here = f"{sys.platform}-{platform.machine()}"
    if here in sizes:
        sizes[here]["keptMB"] = measure_here()
    SIZES.write_text(json.dumps(sizes, indent=2) + "\n", encoding="utf-8")
    print(SIZES.read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
