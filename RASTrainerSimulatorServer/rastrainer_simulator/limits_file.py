"""What clients, views and trials may cost at one site: `limits.json` of the user's settings."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any, TypeVar

from rastrainer.errors import InputError
from rastrainer.files import read_json
from rastrainer_simulator.igtl.limits import Limits
from rastrainer_simulator.trial_limits import TrialLimits
from rastrainer_simulator.view_server.limits import ViewLimits

FILE_NAME = "limits.json"
MOST_BYTES = 2**14
LARGEST = {"_share": 1, "_bytes": 2**30, "_per_s": 2**20, "_s": 86_400}
"""By how a limit's name ends: a limit that limits nothing is a mistake."""
LARGEST_COUNT = 2**16

T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class ServerLimits:
    """What everyone at the server's ports may cost.

    Attributes:
        clients: those over OpenIGTLink.
        views: the window, browsers and headsets.
        trials: those that any of these begin.
    """

    clients: Limits = dataclasses.field(default_factory=Limits)
    views: ViewLimits = dataclasses.field(default_factory=ViewLimits)
    trials: TrialLimits = dataclasses.field(default_factory=TrialLimits)


def read_limits(folder: Path) -> ServerLimits:
    """Return the limits that the file in a folder sets; what it leaves out is as by default.

    Raises:
        InputError: the file cannot be read, or sets what is no limit.
    """
    path = folder / FILE_NAME
    if not path.exists():
        return ServerLimits()
    groups = {field.name: field.default_factory for field in dataclasses.fields(ServerLimits)}
    values = read_json(path, MOST_BYTES)
    if not isinstance(values, dict) or not values.keys() <= groups.keys():
        raise InputError(f"{path} must be a JSON object with any of {', '.join(groups)}.")
    return ServerLimits(
        **{name: _limits(path, name, groups[name], value) for name, value in values.items()}
    )


def _limits(path: Path, group: str, kind: type[T], values: Any) -> T:
    defaults = dataclasses.asdict(kind())
    if not isinstance(values, dict) or not values.keys() <= defaults.keys():
        listed = ", ".join(defaults)
        raise InputError(f"{path}: {group} must be a JSON object with any of {listed}.")
    for name, value in values.items():
        is_whole = isinstance(defaults[name], int)
        most = next((most for end, most in LARGEST.items() if name.endswith(end)), LARGEST_COUNT)
        if type(value) not in ((int,) if is_whole else (int, float)) or not 0 < value <= most:
            what = "whole number" if is_whole else "number"
            raise InputError(f"{path}: {group}.{name} must be a {what} above 0, up to {most}.")
    return kind(**values)
