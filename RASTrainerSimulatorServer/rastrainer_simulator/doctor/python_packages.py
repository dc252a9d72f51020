"""Python itself, and the packages that the simulator is made of."""

from __future__ import annotations

import importlib
import os
import platform
import sys
from collections.abc import Iterator
from importlib import metadata

from rastrainer.errors import InputError
from rastrainer_simulator.doctor.finding import Finding, Verdict

OLDEST_PYTHON = (3, 10)
MODULES = {
    "aiohttp": "aiohttp",
    "numpy": "numpy",
    "pygame-ce": "pygame",
    "python-fcl": "fcl",
    "trimesh": "trimesh",
    "trustme": "trustme",
    "vtk": "vtkmodules.vtkCommonCore",
    "yourdfpy": "yourdfpy",
}
"""Package → a module of it that is loaded to see whether it can be."""
FASTER = {"fastcrc": "fastcrc", "pin": "pinocchio"}
"""What everything works without, only slower."""


def check_python() -> Iterator[Finding]:
    """Tell the version of Python, and which packages are missing or broken."""
    version = platform.python_version()
    if sys.version_info[:2] >= OLDEST_PYTHON:
        yield Finding("python", Verdict.OK, f"Python {version} at {sys.executable}.")
    else:
        least = ".".join(map(str, OLDEST_PYTHON))
        yield Finding(
            "python", Verdict.PROBLEM, f"Python {version} is too old.", f"Install {least} or newer."
        )
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    broken = list(_broken(MODULES, Verdict.PROBLEM))
    yield from broken
    yield from _broken({} if sys.platform == "win32" else FASTER, Verdict.WARNING)
    yield from _kinematics()
    if not broken:
        told = ", ".join(f"{name} {metadata.version(name)}" for name in sorted(MODULES))
        yield Finding("packages", Verdict.OK, f"All packages can be loaded: {told}.")


def _kinematics() -> Iterator[Finding]:
    try:
        from rastrainer_simulator.robot.kinematics import kinematics_name

        name = kinematics_name()
    except (ImportError, InputError) as error:
        remedy = "Set RASTRAINER_KINEMATICS=numpy, or unset it and install pin."
        sentence = f"The robot's kinematics cannot be computed: {error}"
        yield Finding("kinematics", Verdict.PROBLEM, sentence, remedy)
        return
    yield Finding("kinematics", Verdict.OK, f"{name} computes the robot's kinematics.")


def _broken(modules: dict[str, str], verdict: Verdict) -> Iterator[Finding]:
    for package, module in modules.items():
        try:
            importlib.import_module(module)
            metadata.version(package)
        except Exception as error:  # a broken library may raise anything
            yield Finding(
                "packages",
                verdict,
                f"The package {package} cannot be loaded ({error}).",
                f"Install it anew: {sys.executable} -m pip install --force-reinstall {package}",
            )
