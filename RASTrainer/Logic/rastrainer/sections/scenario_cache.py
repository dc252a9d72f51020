"""The available scenarios, found by the name in a trial's record."""

from __future__ import annotations

import json
from functools import partial
from itertools import count
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario.library import (
    ListedScenario,
    list_folder,
    list_scenarios,
    user_library,
)
from rastrainer.scenario.scenario import FILE_NAME, Scenario, load_scenario
from rastrainer.scenario.writer import scenario_name
from rastrainer.slicer.translation import _

LONGEST_STEM = 30
"""Characters of a title to which a number is added: a name of 40 must have room for it."""


class ScenarioCache:
    """Reads scenarios when they are needed, and again after they were rebuilt.

    Call `refresh` after one is added. May be used in any thread.
    """

    def __init__(self, *libraries: Path) -> None:
        self._list = partial(list_scenarios, libraries, self._listOne)
        self._lines: dict[Path, tuple[tuple, ListedScenario]] = {}
        self._listed: tuple[ListedScenario, ...] | None = None
        self._scenarios: dict[str, tuple[tuple[int, int], Scenario]] = {}

    def listed(self) -> tuple[ListedScenario, ...]:
        """Return the available scenarios; an unusable one says why."""
        listed = self._listed
        if listed is None:
            self._listed = listed = tuple(self._list())
        return listed

    def _listOne(self, folder: Path) -> ListedScenario:
        """List a scenario again, which takes long, only if one of its files has changed."""
        stamp, line = self._lines.get(folder, ((), None))
        present = tuple((str(path), _stamp(path)) for path in sorted(folder.rglob("*")))
        if line is None or stamp != present:
            line = list_folder(folder)
            self._lines[folder] = present, line
        return line

    def refresh(self) -> None:
        """List and read again when needed next."""
        self._listed = None
        self._scenarios.clear()

    def find(self, name: str) -> Scenario:
        """Return the scenario of that name, which may have been added since the last look."""
        stamp, scenario = self._scenarios.get(name, ((0, 0), None))
        if scenario is None or stamp != _stamp(scenario.folder / FILE_NAME):
            self._listed = None
            folders = {entry.name: entry.folder for entry in self.listed()}
            if name not in folders:
                usable = [entry.name for entry in self.listed() if not entry.problem]
                raise InputError(
                    f"The scenario {json.dumps(name)} is not here; those that are: "
                    f"{', '.join(usable) or 'none'}."
                )
            stamp = _stamp(folders[name] / FILE_NAME)
            scenario = load_scenario(folders[name])
            self._scenarios[name] = stamp, scenario
        return scenario

    def newName(self, title: str) -> str:
        """Return the name of a scenario of that title, which is not here yet."""
        name = scenario_name(title)
        self._listed = None
        taken = {entry.name: entry.folder for entry in self.listed()}
        if name not in taken:
            return name
        titles = (f"{title[:LONGEST_STEM]} {number}" for number in count(2))
        free = next(each for each in titles if scenario_name(each) not in taken)
        sentence = _(
            "There already is a scenario {name}: give this one another title, such as {free}."
        )
        if taken[name].parent == user_library():
            sentence = _(
                "There already is a scenario {name}: give this one another title, such as {free}, "
                "or first move the folder {folder} elsewhere."
            )
        raise InputError(sentence.format(name=name, free=free, folder=taken[name]))


def _stamp(path: Path) -> tuple[int, int]:
    """Return a value that changes with a file."""
    try:
        status = path.stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_size
