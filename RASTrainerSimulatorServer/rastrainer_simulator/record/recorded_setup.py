"""What a trial was recorded with, to simulate it again or to resume it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import TouchRule
from rastrainer_simulator.core.settings import SimulationSettings, settings_from_json
from rastrainer_simulator.core.setup import SimulationSetup, load_setup


def setup_of(
    header: Mapping[str, Any],
    scenario_folder: Path | None = None,
    robot_meshes: Path | None = None,
) -> SimulationSetup:
    """Return the setup that a journal's header describes.

    Raises:
        InputError: scenario or robot are others here, or the header is not usable.
    """
    try:
        settings = settings_from_json(SimulationSettings, _with_touch_rule(header["settings"]))
        name, sha256 = header["scenario"]["name"], header["scenario"]["sha256"]
    except (KeyError, TypeError, AttributeError):
        raise InputError("The journal's header lacks the scenario or the settings.") from None
    setup = load_setup(scenario_folder, settings, robot_meshes=robot_meshes)
    if setup.scenario_sha256 != sha256:
        raise InputError(
            f"The trial was recorded with a scenario {name!r} whose files differ from those of "
            f"{setup.scenario.name!r} here: give its folder with --scenario."
        )
    if setup.robot.name != header.get("robot"):
        raise InputError(f"The trial was recorded with another robot than {setup.robot.name} here.")
    return setup


def _with_touch_rule(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return recorded settings with the touch rule that was in force before there was a choice."""
    rule = {"touch_rule": TouchRule.WITHIN_RADIUS.value}
    return {**settings, "training": {**rule, **settings.get("training", {})}}
