"""Scenarios on disk: found, named, and copied, packed and compared by the simulator's program."""

from __future__ import annotations

import contextlib
import json
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.scenario.library import (
    ListedScenario,
    list_folder,
    list_scenarios,
    unpack,
    user_library,
)
from rastrainer.scenario.scenario import FILE_NAME, Scenario, load_scenario
from rastrainer.scenario.writer import scenario_name
from rastrainer.sections.simulator_logic import SimulatorLogic
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.scene.nodes import labelsOf, worldPoints
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress, no_progress

LONGEST_STEM = 30
"""Characters of a title to which a number is added: a name of 40 must have room for it."""


class ScenarioCache:
    """Reads scenarios when they are needed, and again after they were rebuilt, in any thread."""

    def __init__(self, *libraries: Path) -> None:
        self._libraries = libraries
        self._lines: dict[Path, tuple[tuple, ListedScenario]] = {}
        self._scenarios: dict[str, tuple[tuple[int, int], Scenario]] = {}

    def listed(self) -> list[ListedScenario]:
        """Return the available scenarios; an unusable one says why."""

        def listOne(folder: Path) -> ListedScenario:
            # That takes long: only if one of its files has changed.
            stamp, line = self._lines.get(folder, ((), None))
            present = tuple((str(path), _stamp(path)) for path in sorted(folder.rglob("*")))
            if line is None or stamp != present:
                line = list_folder(folder)
                self._lines[folder] = present, line
            return line

        return list_scenarios(self._libraries, listOne)

    def find(self, name: str) -> Scenario:
        """Return the scenario of that name, which may have been added since the last look."""
        stamp, scenario = self._scenarios.get(name, ((0, 0), None))
        if scenario is None or stamp != _stamp(scenario.folder / FILE_NAME):
            listed = self.listed()
            folders = {entry.name: entry.folder for entry in listed}
            if name not in folders:
                usable = [entry.name for entry in listed if not entry.problem]
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
    with contextlib.suppress(OSError):
        status = path.stat()
        return status.st_mtime_ns, status.st_size
    return 0, 0


@dataclass(frozen=True)
class ScenarioFiles:
    """Scenarios on disk, which the simulator's program writes, each into a folder of `library`.

    `progress` is called while it works: it may let the application draw, and may raise to cancel.
    """

    simulator: SimulatorLogic
    cache: ScenarioCache
    library: Path

    def add(self, title: str, make: Callable[[Path], object]) -> Scenario:
        """Return the scenario that `make` makes in the folder it is given."""
        folder = self.library / self.cache.newName(title)
        make(folder)
        return load_scenario(folder)

    def importScenario(self, package: Path, progress: Progress = no_progress) -> Scenario:
        unpacked = inBackground(lambda report: unpack(package, self.library, report), progress)
        return load_scenario(unpacked)

    def pack(self, name: str, package: str, options: list[str], progress: Progress) -> str:
        """Write a scenario as a zip file; return a sentence about removed parts."""
        words = ["pack", str(self.cache.find(name).folder), package, *options]
        return self.run(words, progress)

    def saveWith(self, plan: list[str], name: str, title: str, progress: Progress) -> Scenario:
        """Copy a scenario with a part replaced, and return the copy.

        `plan` are arguments of `rastrainer scenario plan`, such as `--landmarks` with a file.
        """
        words = ["plan", str(self.cache.find(name).folder), f"--title={title}", *plan]
        return self.add(title, lambda folder: self.run([*words, "-o", str(folder)], progress))

    def run(self, words: list[str], progress: Progress, mayFail: bool = False) -> str:
        """Run `rastrainer scenario`; see `SimulatorLogic.run`."""
        return self.simulator.run(["scenario", *words], progress, mayFail)


def planArguments(*planned: Any | None) -> list[str]:
    """Return the arguments of `rastrainer scenario` for lists of targets, and a line."""
    words = []
    for node in planned:
        if node is None:
            continue
        points = worldPoints(node)
        if not node.IsA("vtkMRMLMarkupsLineNode"):
            for name, place in zip(labelsOf(node), points, strict=True):
                words += ["--target", name, *map(str, place.tolist())]
        elif len(points) == 2:
            words += ["--trajectory", node.GetName(), *map(str, points.ravel().tolist())]
        else:
            raise InputError(_("The trajectory needs two points: its entry and its target."))
    return words


LIMIT_BYTES = 1 << 20
KEYS = ("residual_mm", "true_tre_mm", "expected_tre_mm", "interval_holds_share")


def compareMethods(
    simulator: SimulatorLogic, scenario: Scenario, trials: int, shiftMm: float, progress: Progress
) -> dict[str, tuple[float, ...]]:
    """Return how each method for which a head has the points registers simulated trials.

    `shiftMm` is the skin's RMS shift between imaging and operation. The numbers of a method are
    root mean squares over trials of residual, true and expected target error, mm; the share of the
    95 % intervals that hold the true error; and medians of the interval's ends, mm.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "methods"
        words = ["compare-methods", "--scenario", str(scenario.folder), "-o", str(folder)]
        words += ["--trials", str(trials), "--skin-shift", str(shiftMm)]
        simulator.run(words, progress)
        compared = read_json(folder / "methods.json", LIMIT_BYTES)
    try:
        numbers = {}
        for name, values in compared["methods"].items():
            low, high = values["interval_mm"]
            numbers[name] = tuple(map(float, (*map(values.get, KEYS), low, high)))
        return numbers
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError(_("The simulator's program has a different version.")) from None
