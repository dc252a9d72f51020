"""The scenarios at hand, found by the name that a trial's record gives."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario import Scenario, load_scenario
from rastrainer.scenario_library import ListedScenario, list_folders, list_scenarios
from rastrainer.scenario_writer import scenario_name
from rastrainer.slicer.translation import _


class ScenarioShelf:
    """Reads scenarios when they are first asked for; `refresh` looks what has come since."""

    def __init__(self, *folders: Path) -> None:
        """Put the scenarios of these folders on the shelf."""
        self._list: Callable[[], Iterable[ListedScenario]] = lambda: list_folders(folders)
        self._listed: tuple[ListedScenario, ...] | None = None
        self._scenarios: dict[str, Scenario] = {}

    @classmethod
    def below(cls, *libraries: Path) -> ScenarioShelf:
        """Return the shelf of all scenarios in these folders of folders."""
        shelf = cls()
        shelf._list = lambda: list_scenarios(libraries)
        return shelf

    def listed(self) -> tuple[ListedScenario, ...]:
        """Return what is on the shelf; what cannot be used says why."""
        if self._listed is None:
            self._listed = tuple(self._list())
        return self._listed

    def refresh(self) -> None:
        """Look anew at the next question."""
        self._listed = None
        self._scenarios.clear()

    def find(self, name: str) -> Scenario:
        """Return the scenario of that name, which may have come since it was last looked.

        Raises:
            InputError: there is none, or it cannot be used.
        """
        if name not in self._scenarios:
            self._listed = None
            self._scenarios[name] = load_scenario(self._folder(name))
        return self._scenarios[name]

    def newName(self, title: str) -> str:
        """Return the name of a scenario of that title, which is not here yet.

        Raises:
            InputError: there is one of that name, or no name can be made of the title.
        """
        name = scenario_name(title)
        if any(entry.name == name for entry in self.listed()):
            raise InputError(
                _("There is a scenario {name} already: give this one another title.").format(
                    name=name
                )
            )
        return name

    def _folder(self, name: str) -> Path:
        for entry in self.listed():
            if entry.name == name:
                return entry.folder
        known = ", ".join(entry.name for entry in self.listed() if not entry.problem) or "none"
        raise InputError(f"The scenario {json.dumps(name)} is not here; those that are: {known}.")
