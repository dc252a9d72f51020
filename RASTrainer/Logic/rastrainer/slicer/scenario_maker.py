"""Makes scenarios of volumes in the scene, and takes and gives scenarios as zip files."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.markups import write_markups
from rastrainer.point_list import PointList
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario import UNKNOWN_LICENSE, Scenario, load_scenario
from rastrainer.scenario_package import unpack
from rastrainer.scenario_setup import SetUp, write_setup
from rastrainer.scenario_writer import scenario_name
from rastrainer.slicer.child_process import ChildProcess
from rastrainer.slicer.control_points import worldPoints
from rastrainer.slicer.polydata import trianglesPolyData
from rastrainer.slicer.scenario import SKIN_COLOR
from rastrainer.slicer.scenario_shelf import ScenarioShelf
from rastrainer.slicer.scene import ROLE_ATTRIBUTE, Role, findNode, findOrAddNode
from rastrainer.slicer.simulator_desk import SimulatorDesk
from rastrainer.slicer.translation import _
from rastrainer.tasks import LABELS

SOURCE = "The volume {name} in 3D Slicer."
PREVIEWED_ATTRIBUTE = "RASTrainer.previewed"
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

    def preview(self, volumeNode: Any, wishes: ScenarioWishes, progress: Progress) -> Any:
        """Show the head that is found, and return its `vtkMRMLSegmentationNode`.

        The Segment Editor may change the segment; `make` then takes it as it is.

        Raises:
            InputError: there is no head in the volume.
        """
        # Only here: scipy takes time to import.
        from rastrainer.slicer.head.extraction import find_head, skin_of
        from rastrainer.slicer.head.scenario_build import in_background
        from rastrainer.slicer.head.segment import show_segment
        from rastrainer.slicer.head.volume_checks import check_head, check_volume

        volume, settings = self._volume(volumeNode), self._settings(wishes)
        check_volume(volume)
        found = in_background(lambda tell: find_head(volume, settings, tell), progress)
        skin = skin_of(found, settings, progress)
        check_head(skin)
        node = findOrAddNode(
            self._scene, "vtkMRMLSegmentationNode", Role.HEAD_SEGMENT, "Head to be edited"
        )
        show_segment(node, found)
        node.SetReferenceImageGeometryParameterFromVolumeNode(volumeNode)
        node.SetAttribute(PREVIEWED_ATTRIBUTE, volumeNode.GetID())
        model = findOrAddNode(self._scene, "vtkMRMLModelNode", Role.HEAD_PREVIEW, "Head as found")
        model.SetAndObservePolyData(trianglesPolyData(skin.vertices, skin.triangles))
        model.GetDisplayNode().SetColor(SKIN_COLOR)
        return node

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

        volume, segment = self._volume(volumeNode), self._segment(volumeNode)
        settings = self._settings(wishes)
        command, environment = self._simulator.command([], ownProgram)
        title = wishes.title.strip() or volumeNode.GetName()
        folder = self._newFolder(title)
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

    def takeIn(self, package: Path) -> Scenario:
        """Unpack a scenario's zip file into the library.

        Raises:
            InputError: it cannot be used; nothing has changed.
        """
        folder = unpack(package, self._library)
        self._shelf.refresh()
        return load_scenario(folder)

    def give(
        self,
        name: str,
        package: Path,
        keepsFace: bool = False,
        keepsNames: bool = False,
        ownProgram: str = "",
    ) -> str:
        """Write a scenario as a zip file and return a sentence that says what was taken off.

        Args:
            name: of the scenario.
            package: the new file.
            keepsFace: whether the head keeps its face and skull.
            keepsNames: whether title, name and source stay, which may be the patient's name.
            ownProgram: as in `make`.

        Raises:
            InputError: it cannot be written.
        """
        words = ["scenario", "pack", str(self._shelf.find(name).folder), str(package)]
        words += ["--keep-face"] if keepsFace else []
        words += ["--keep-names"] if keepsNames else []
        command, environment = self._simulator.command(words, ownProgram)
        child = ChildProcess(command, environment)
        status = child.wait()
        said = [line for line in child.takeLines() if line] or [_("it said nothing")]
        if status != 0:
            raise InputError(said[-1].removeprefix("rastrainer: "))
        return said[-1]

    def _newFolder(self, title: str) -> Path:
        """Return where a scenario of that title comes.

        Raises:
            InputError: there is one of that name, or no name can be made of the title.
        """
        name = scenario_name(title)
        if any(entry.name == name for entry in self._shelf.listed()):
            raise InputError(
                _("There is a scenario {name} already: give this one another title.").format(
                    name=name
                )
            )
        return self._library / name

    def _volume(self, volumeNode: Any) -> Any:
        from rastrainer.slicer.head.volume import volume_from_node

        if volumeNode is None:
            raise InputError(_("Choose a volume first."))
        if volumeNode.GetImageData() is None:
            raise InputError(
                _("The volume {name} holds no image.").format(name=volumeNode.GetName())
            )
        return volume_from_node(volumeNode)

    def _settings(self, wishes: ScenarioWishes) -> Any:
        from rastrainer.slicer.head.extraction import HeadSettings

        return HeadSettings(threshold=wishes.threshold, base_mm=wishes.cutMm)

    def _segment(self, volumeNode: Any) -> Any:
        """Return the segment that was previewed of this volume, None where none was."""
        from rastrainer.slicer.head.segment import SEGMENT_NAME, volume_of_segment

        node = findNode(self._scene, "vtkMRMLSegmentationNode", Role.HEAD_SEGMENT)
        if node is None or node.GetAttribute(PREVIEWED_ATTRIBUTE) != volumeNode.GetID():
            return None
        segment = node.GetSegmentation().GetSegmentIdBySegmentName(SEGMENT_NAME)
        return volume_of_segment(node, segment)

    def _words(self, wishes: ScenarioWishes, folder: Path) -> tuple[str, ...]:
        """Return the arguments of `rastrainer scenario tasks`; files go into `folder`."""
        setUp = folder / "setup.json"
        write_setup(setUp, wishes.setUp)
        words = ["--setup", str(setUp)]
        if wishes.targets is not None:
            for row, position in enumerate(worldPoints(wishes.targets)):
                name = wishes.targets.GetNthControlPointLabel(row)
                words += ["--target", name, *map(str, position.tolist())]
        if wishes.trajectory is not None:
            ends = worldPoints(wishes.trajectory)
            if len(ends) != 2:
                raise InputError(_("The trajectory needs two points: its entry and its target."))
            words += ["--trajectory", wishes.trajectory.GetName(), *map(str, ends.ravel().tolist())]
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
