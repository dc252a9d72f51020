"""The setup, versions, display and tutorial that are recorded with a trial."""

from __future__ import annotations

import contextlib
import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Annotated

import rastrainer
from rastrainer.errors import InputError
from rastrainer.journal.entries import (
    DisplayReport,
    Entry,
    GhostReport,
    GuidanceReport,
    JournalHeader,
    TutorialReport,
)
from rastrainer.json_checks import number, one_of, whole_number
from rastrainer.json_records import record_from_json
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.input.inputs import SourceKind

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


# Looked up when imported: it reads folders, and a trial starts within a tick.
_OF_PACKAGES: dict[str, str] = {}
for _package in PACKAGES:
    with contextlib.suppress(metadata.PackageNotFoundError):
        _OF_PACKAGES[_package] = metadata.version(_package)


def setup_of(
    header: JournalHeader, scenario_folder: Path | None = None, robot_meshes: Path | None = None
) -> SimulationSetup:
    # A setting that is unknown here would be without effect.
    settings = record_from_json(
        SimulationSettings, header.settings, "The journal's settings", only_known=True
    )
    setup = load_setup(scenario_folder, settings, robot_meshes=robot_meshes)
    name, procedure = setup.scenario.name, header.procedure
    other = {
        "": "",
        "scenario": f"a scenario {header.scenario.name!r} whose files differ from those of "
        f"{name!r} here: give its folder with --scenario",
        "landmarks": f"other landmarks than those of {name!r} here: give its folder with "
        "--scenario",
        "procedure": f"a procedure {procedure.name if procedure else ''!r} that differs from that "
        f"of {name!r} here: give its folder with --scenario",
        "robot": f"another robot than {setup.robot.name} here",
    }[setup.difference(header)]
    if other:
        raise InputError(f"The trial was recorded with {other}.")
    return setup


@dataclass(frozen=True, kw_only=True)
class TutorialOutcome(TutorialReport):
    """A finished tutorial of a trainee, as its own file keeps it."""

    trainee: str
    device: Annotated[str, one_of(*(kind.value for kind in SourceKind))]
    step_times_s: Mapping[str, Annotated[float, number(0, 1e6, "s")]] = field(default_factory=dict)
    format_version: Annotated[int, whole_number(1, 1)] = 1


def display_summary(reports: Sequence[Entry]) -> dict[str, str | float]:
    """Return `display` of a trial's record: its last view, all frames, and the aids."""
    drawn = [each for each in reports if isinstance(each, DisplayReport)]
    aids: dict[str, str] = {}
    for name, kind in (("guidance", GuidanceReport), ("ghost", GhostReport)):
        given = [getattr(each, name) for each in reports if isinstance(each, kind)]
        aids |= {name: given[-1]} if given and given[-1] else {}
    if not drawn:
        return {**aids}
    return {
        "kind": drawn[-1].view,
        **({"device": drawn[-1].device} if drawn[-1].device else {}),
        **aids,
        "refreshHz": drawn[-1].refresh_hz,
        "shownFrames": sum(each.shown for each in drawn),
        "droppedFrames": sum(each.dropped for each in drawn),
    }
