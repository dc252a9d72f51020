"""What a trial was recorded with: scenario, robot, settings and versions."""

from __future__ import annotations

import contextlib
import platform
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path
from types import MappingProxyType
from typing import Any

import rastrainer
from rastrainer.errors import InputError
from rastrainer.protocol import PROTOCOL_VERSION, TouchRule
from rastrainer_simulator.core.settings import SimulationSettings, settings_from_json
from rastrainer_simulator.core.setup import SimulationSetup, load_setup

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


# Looked up when imported: it reads folders, and a trial starts within a tick.
_OF_PACKAGES = _of_packages()


def setup_of(
    header: Mapping[str, Any], scenario_folder: Path | None = None, robot_meshes: Path | None = None
) -> SimulationSetup:
    """Return the setup that a journal's header describes.

    Raises:
        InputError: scenario or robot differ here, or the header is not usable.
    """
    try:
        settings = settings_from_json(SimulationSettings, _with_touch_rule(header["settings"]))
        name, sha256 = header["scenario"]["name"], header["scenario"]["sha256"]
    except (KeyError, TypeError, AttributeError):
        raise InputError("The journal's header lacks the scenario or the settings.") from None
    setup = load_setup(scenario_folder, settings, robot_meshes=robot_meshes)
    if not setup.is_of(sha256):
        raise InputError(
            f"The trial was recorded with a scenario {name!r} whose files differ from those of "
            f"{setup.scenario.name!r} here: give its folder with --scenario."
        )
    try:
        is_same_procedure = setup.matches_procedure(header)
        has_same_landmarks = setup.matches_landmarks(header)
    except (KeyError, TypeError, AttributeError):
        raise InputError(
            "The journal's header does not name its procedure or method as it should."
        ) from None
    if not has_same_landmarks:
        raise InputError(
            f"The trial was recorded with other landmarks than those of {setup.scenario.name!r} "
            "here: give its folder with --scenario."
        )
    if not is_same_procedure:
        raise InputError(
            f"The trial was recorded with a procedure {header['procedure']['name']!r} that differs "
            f"from that of {setup.scenario.name!r} here: give its folder with --scenario."
        )
    if setup.robot.name != header.get("robot"):
        raise InputError(f"The trial was recorded with another robot than {setup.robot.name} here.")
    return setup


def _with_touch_rule(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return recorded settings, with the former touch rule for those that have none."""
    rule = {"touch_rule": TouchRule.WITHIN_RADIUS.value}
    return {**settings, "training": {**rule, **settings.get("training", {})}}
