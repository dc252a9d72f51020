"""Makes scenarios of volumes in the scene."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.markups import write_markups
from rastrainer.point_list import PointList
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario import UNKNOWN_LICENSE, Scenario
from rastrainer.scenario_setup import SetUp, write_setup
from rastrainer.slicer.control_points import worldPoints
from rastrainer.slicer.head_preview import HeadPreview
from rastrainer.slicer.scenario_files import planWords
from rastrainer.slicer.scenario_shelf import ScenarioShelf
from rastrainer.slicer.scene import ROLE_ATTRIBUTE
from rastrainer.slicer.simulator_desk import SimulatorDesk
from rastrainer.slicer.translation import _
from rastrainer.tasks import LABELS

if TYPE_CHECKING:
    from rastrainer.slicer.head.extraction import HeadSettings

SOURCE = "The volume {name} in 3D Slicer."
MOST_HAND_PLACED = 6

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class ScenarioWishes:
    """What is wanted of a scenario besides its volume.

    Attributes:
        title: for people; empty takes the volume's name.
        source: where the images come from; empty names the volume.
        license: under which the scenario may be used; empty says that nothing is known.
        threshold: value that parts air from skin; None finds it.
        cutMm: height (S) of the flat base; None finds it.
        hasSkull: whether the skull is wanted.
        setUp: how the head stands before the robot.
        targets: a `vtkMRMLMarkupsFiducialNode` of planned targets, or None.
        trajectory: a `vtkMRMLMarkupsLineNode` from the entry to the target, or None.
        isHandPlaced: whether the scene's own point lists of 15 are the tasks, in their order.
    """

    title: str = ""
    source: str = ""
    license: str = ""
    threshold: float | None = None
    cutMm: float | None = None
    hasSkull: bool = True
    setUp: SetUp = field(default_factory=SetUp)
    targets: Any = None
    trajectory: Any = None
    isHandPlaced: bool = False


class ScenarioMaker:
    """What the panel New scenario does."""

    def __init__(
        self, scene: Any, simulator: SimulatorDesk, shelf: ScenarioShelf, library: Path
    ) -> None:
        """Scenarios come into the folder `library`, each into a folder of its own."""
        self._scene = scene
        self._simulator = simulator
        self._shelf = shelf
        self._library = library
        self._preview = HeadPreview(scene)

    def preview(self, volumeNode: Any, wishes: ScenarioWishes, progress: Progress) -> list[str]:
        """Show the head that is found, and return warnings, one sentence each.

        The Segment Editor may change its segment; `make` then takes it as it is. Arguments are
        those of `make`.

        Raises:
            InputError: there is no head in the volume.
        """
        return self._preview.show(_chosen(volumeNode), _settings(wishes), progress)

    def make(
        self,
        volumeNode: Any,
        wishes: ScenarioWishes,
        progress: Progress,
        ownProgram: str = "",
    ) -> tuple[Scenario, list[str]]:
        """Make a scenario in the library and return it with warnings, one sentence each.

        Args:
            volumeNode: T1-weighted MRI or CT of a head; the segment that `preview` has made of it
                is taken where there is one.
            wishes: what else is wanted.
            progress: told each step's name and the share of the work done, ten times a second; it
                may let the application draw, and may raise to cancel: then nothing is left behind.
            ownProgram: a `rastrainer` installed elsewhere; that of the simulator where empty.

        Raises:
            InputError: something cannot be used; the sentence says what.
        """
        from rastrainer.slicer.head.head_draft import make_draft
        from rastrainer.slicer.head.scenario_build import build_scenario
        from rastrainer.slicer.head.volume import volume_from_node

        volume, settings = volume_from_node(_chosen(volumeNode)), _settings(wishes)
        segment = self._preview.segment(volumeNode, settings)
        command, environment = self._simulator.command([], ownProgram)
        title = wishes.title.strip() or volumeNode.GetName()
        folder = self._library / self._shelf.newName(title)
        source = wishes.source.strip() or SOURCE.format(name=volumeNode.GetName())
        terms = wishes.license.strip() or UNKNOWN_LICENSE
        words = [f"--title={title}", f"--source={source}", f"--license={terms}"]
        with tempfile.TemporaryDirectory() as temporary:
            made = build_scenario(
                lambda tell: make_draft(volume, settings, wishes.hasSkull, tell, segment),
                folder,
                [*words, *self._words(wishes, Path(temporary))],
                command,
                environment,
                progress,
            )
        self._shelf.refresh()
        return made

    def _words(self, wishes: ScenarioWishes, folder: Path) -> tuple[str, ...]:
        """Return the arguments of `rastrainer scenario tasks`; files go into `folder`."""
        setUp = folder / "setup.json"
        write_setup(setUp, wishes.setUp)
        words = ["--setup", str(setUp)]
        words += planWords(wishes.targets, wishes.trajectory)
        if wishes.isHandPlaced:
            words += ["--tasks", *self._writeHandPlaced(folder)]
        return tuple(words)

    def _writeHandPlaced(self, folder: Path) -> list[str]:
        paths = []
        for node in self._handPlaced()[:MOST_HAND_PLACED]:
            paths.append(folder / f"task-{len(paths)}.mrk.json")
            write_markups(paths[-1], PointList(LABELS, worldPoints(node)))
        if not paths:
            raise InputError(
                _("There is no point list of {count} fiducials in the scene.").format(
                    count=FIDUCIAL_COUNT
                )
            )
        return [str(path) for path in paths]

    def _handPlaced(self) -> list[Any]:
        nodes = self._scene.GetNodesByClass("vtkMRMLMarkupsFiducialNode")
        nodes.UnRegister(None)
        found = [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]
        return [
            node
            for node in found
            if node.GetAttribute(ROLE_ATTRIBUTE) is None
            and node.GetNumberOfControlPoints() == FIDUCIAL_COUNT
        ]


def _chosen(volumeNode: Any) -> Any:
    if volumeNode is None:
        raise InputError(_("Choose a volume first."))
    return volumeNode


def _settings(wishes: ScenarioWishes) -> HeadSettings:
    from rastrainer.slicer.head.extraction import HeadSettings

    return HeadSettings(threshold=wishes.threshold, base_mm=wishes.cutMm)
