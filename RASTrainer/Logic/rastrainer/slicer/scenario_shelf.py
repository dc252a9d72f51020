"""The scenarios at hand, found by the name that a trial's record gives."""

from __future__ import annotations

import json
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario import FILE_NAME, Scenario, load_scenario


class ScenarioShelf:
    """Reads scenarios when they are first asked for, and once."""

    def __init__(self, *folders: Path) -> None:
        """Put the scenarios of these folders on the shelf."""
        self._folders = folders
        self._scenarios: tuple[Scenario, ...] | None = None

    @classmethod
    def below(cls, folder: Path) -> ScenarioShelf:
        """Return the shelf of all scenario folders in a folder."""
        return cls(*sorted(path.parent for path in folder.glob(f"*/{FILE_NAME}")))

    def scenarios(self) -> tuple[Scenario, ...]:
        """Return all scenarios of the shelf.

        Raises:
            InputError: a scenario's folder cannot be used.
        """
        if self._scenarios is None:
            self._scenarios = tuple(load_scenario(folder) for folder in self._folders)
        return self._scenarios

    def find(self, name: str) -> Scenario:
        """Return the scenario of that name.

        Raises:
            InputError: there is none, or a scenario's folder cannot be used.
        """
        for scenario in self.scenarios():
            if scenario.name == name:
                return scenario
        known = ", ".join(scenario.name for scenario in self.scenarios()) or "none"
        raise InputError(f"The scenario {json.dumps(name)} is not here; those that are: {known}.")
