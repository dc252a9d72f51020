"""The head that is found in a volume, shown before a scenario is made, to accept or to change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.program.child_process import Run
from rastrainer.slicer.scene.nodes import Role, findNode, findOrAddNode
from rastrainer.slicer.scene.scenario_nodes import SKIN_COLOR, meshPolyData
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress

if TYPE_CHECKING:
    from rastrainer.head.mesh import HeadMesh
    from rastrainer.slicer.head.volume import HeadBody, HeadSettings, SegmentImage

FIND_SKIN = "rastrainer.slicer.head.head_draft:findSkin"
PREVIEWED_ATTRIBUTE = "RASTrainer.previewed"
SETTINGS_ATTRIBUTE = "RASTrainer.previewedWith"


def findSkin(
    run: Run, volumeNode: Any, settings: HeadSettings | None, progress: Progress
) -> tuple[HeadBody, HeadMesh, list[str]]:
    """Return the head in a `vtkMRMLScalarVolumeNode`, its skin, and warnings."""
    from rastrainer.slicer.head.volume import imageOfNode

    image, scene = imageOfNode(volumeNode), volumeNode.GetScene()

    def find(report: Progress) -> tuple[HeadBody, HeadMesh, list[str]]:
        found, skin, warnings = run(FIND_SKIN, report, image, settings)
        # Computed here rather than when the segment is shown.
        _ = found.labels
        return found, skin, warnings

    found = inBackground(find, progress)
    if volumeNode.GetScene() is not scene:
        # In a cleared scene the next volume has the same ID, and would be taken for this one.
        raise InputError(_("The volume was removed before its head was found."))
    return found


_DRAFT = (("vtkMRMLSegmentationNode", Role.HEAD_SEGMENT), ("vtkMRMLModelNode", Role.HEAD_PREVIEW))


class HeadPreview:
    """A model of the head that is found, and a segment of it that the Segment Editor may change."""

    def __init__(self, scene: Any, run: Run) -> None:
        self._scene = scene
        self._run = run

    def show(self, volumeNode: Any, settings: HeadSettings, progress: Progress) -> list[str]:
        """Show the head in a `vtkMRMLScalarVolumeNode`; return warnings, one sentence each."""
        from rastrainer.slicer.head.volume import showSegment

        found, skin, warnings = findSkin(self._run, volumeNode, settings, progress)
        node = self._node("vtkMRMLSegmentationNode", Role.HEAD_SEGMENT, "Head to be edited")
        showSegment(node, found)
        node.SetReferenceImageGeometryParameterFromVolumeNode(volumeNode)
        node.SetAttribute(PREVIEWED_ATTRIBUTE, volumeNode.GetID())
        node.SetAttribute(SETTINGS_ATTRIBUTE, repr(settings))
        model = self._node("vtkMRMLModelNode", Role.HEAD_PREVIEW, "Head as found")
        model.SetAndObservePolyData(meshPolyData(skin))
        model.GetDisplayNode().SetColor(SKIN_COLOR)
        self._setVisible(True)
        return warnings

    def hide(self, volumeNode: Any) -> None:
        """Hide the draft, and a rendering of its volume: the result is shown instead."""
        self._setVisible(False)
        for index in range(volumeNode.GetNumberOfDisplayNodes()):
            display = volumeNode.GetNthDisplayNode(index)
            if display is not None and display.IsA("vtkMRMLVolumeRenderingDisplayNode"):
                display.SetVisibility(False)

    def segment(self, volumeNode: Any, settings: HeadSettings) -> SegmentImage | None:
        """Return the segment of the head that is shown of a volume, None where none is."""
        from rastrainer.slicer.head.volume import SEGMENT_NAME, readSegment

        node = findNode(self._scene, "vtkMRMLSegmentationNode", Role.HEAD_SEGMENT)
        if node is None or node.GetAttribute(PREVIEWED_ATTRIBUTE) != volumeNode.GetID():
            return None
        if node.GetAttribute(SETTINGS_ATTRIBUTE) != repr(settings):
            raise InputError(
                _(
                    "The threshold or the cut has been changed since the head was found: find the "
                    "head again, or reset it."
                )
            )
        segment = node.GetSegmentation().GetSegmentIdBySegmentName(SEGMENT_NAME)
        return readSegment(node, segment)

    def _setVisible(self, visible: bool) -> None:
        for className, role in _DRAFT:
            node = findNode(self._scene, className, role)
            if node is not None and node.GetDisplayNode() is not None:
                node.SetDisplayVisibility(visible)

    def _node(self, className: str, role: str, name: str) -> Any:
        """Return a node without a transform, so that it is shown where it was found."""
        node = findOrAddNode(self._scene, className, role, name)
        node.SetAndObserveTransformNodeID(None)
        return node
