"""Takes and gives scenarios as zip files, and keeps a plan in a scenario of one's own."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.progress import Progress
from rastrainer.scenario.package import unpack
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.logic.scenario_cache import ScenarioCache
from rastrainer.slicer.logic.simulator_logic import SimulatorLogic
from rastrainer.slicer.program.child_process import runChild
from rastrainer.slicer.scene.control_points import labelsOf, worldPoints
from rastrainer.slicer.translation import _


class ScenarioFiles:
    """What the panels Scenario and Plan do with scenarios on disk.

    `ownProgram` is a `rastrainer` installed elsewhere; that of the simulator where it is empty.
    `progress` is called while it works: it may let the application draw, and may raise to cancel.
    """

    def __init__(self, simulator: SimulatorLogic, cache: ScenarioCache, library: Path) -> None:
        """Scenarios come into the folder `library`, each into a folder of its own."""
        self._simulator = simulator
        self._cache = cache
        self._library = library

    def importScenario(
        self, package: Path, progress: Progress = lambda _step, _share: None
    ) -> Scenario:
        """Unpack a scenario's zip file into the library.

        Args:
            package: the file.
            progress: see the class.

        Raises:
            InputError: it cannot be used; nothing has changed.
        """
        folder = inBackground(lambda report: unpack(package, self._library, report), progress)
        self._cache.refresh()
        return load_scenario(folder)

    def exportScenario(
        self,
        name: str,
        package: Path,
        keepsFace: bool = False,
        keepsNames: bool = False,
        ownProgram: str = "",
        progress: Progress = lambda _step, _share: None,
    ) -> str:
        """Write a scenario as a zip file and return a sentence that says what was taken off.

        Args:
            name: of the scenario.
            package: the new file.
            keepsFace: whether the head keeps its face and skull.
            keepsNames: whether title, name and source stay, which may be the patient's name.
            ownProgram: see the class.
            progress: see the class.

        Raises:
            InputError: it cannot be written.
        """
        words = ["pack", str(self._cache.find(name).folder), str(package)]
        words += ["--keep-face"] if keepsFace else []
        words += ["--keep-names"] if keepsNames else []
        return self._run(words, ownProgram, progress)

    def savePlan(
        self,
        name: str,
        title: str,
        node: Any,
        ownProgram: str = "",
        progress: Progress = lambda _step, _share: None,
    ) -> Scenario:
        """Copy a scenario with a list in the place of its targets, or a line of its trajectory.

        Args:
            name: of the scenario, which stays as it is.
            title: of the copy.
            node: a `vtkMRMLMarkupsFiducialNode` or a `vtkMRMLMarkupsLineNode`.
            ownProgram: see the class.
            progress: see the class.

        Raises:
            InputError: there is one of that title already, or the plan cannot be carried out.
        """
        folder = self._library / self._cache.newName(title)
        isLine = node.IsA("vtkMRMLMarkupsLineNode")
        plan = planWords(None, node) if isLine else planWords(node, None)
        source = str(self._cache.find(name).folder)
        words = ["plan", source, "-o", str(folder), f"--title={title}", *plan]
        self._run(words, ownProgram, progress)
        self._cache.refresh()
        return load_scenario(folder)

    def _run(self, words: list[str], ownProgram: str, progress: Progress) -> str:
        """Run `rastrainer scenario` and return the last line that it has written."""
        command = self._simulator.command(["scenario", *words], ownProgram)
        ended = runChild(command, progress)
        sentence = ended.lastLine or _("The simulator's program wrote nothing.")
        if ended.exitStatus != 0:
            raise InputError(sentence.removeprefix("rastrainer: "))
        return sentence


def planWords(targets: Any | None, trajectory: Any | None) -> list[str]:
    """Return the arguments of `rastrainer scenario` for a list of targets and a line.

    Raises:
        InputError: the line has not two points.
    """
    words = []
    if targets is not None:
        for name, place in zip(labelsOf(targets), worldPoints(targets), strict=True):
            words += ["--target", name, *map(str, place.tolist())]
    if trajectory is not None:
        ends = worldPoints(trajectory)
        if len(ends) != 2:
            raise InputError(_("The trajectory needs two points: its entry and its target."))
        words += ["--trajectory", trajectory.GetName(), *map(str, ends.ravel().tolist())]
    return words
