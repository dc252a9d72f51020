"""The head that is found in a volume, shown before a scenario is made, to accept or to change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.progress import Progress
from rastrainer.slicer.polydata import trianglesPolyData
from rastrainer.slicer.scenario import SKIN_COLOR
from rastrainer.slicer.scene import Role, findNode, findOrAddNode
from rastrainer.slicer.translation import _

if TYPE_CHECKING:
    from rastrainer.slicer.head.extraction import HeadSettings
    from rastrainer.slicer.head.volume import Volume

PREVIEWED_ATTRIBUTE = "RASTrainer.previewed"
SETTINGS_ATTRIBUTE = "RASTrainer.previewedWith"


class HeadPreview:
    """A model of the head that is found, and a segment of it that the Segment Editor may change."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene

    def show(self, volumeNode: Any, settings: HeadSettings, progress: Progress) -> list[str]:
        """Show the head in a `vtkMRMLScalarVolumeNode`; return warnings, one sentence each.

        Raises:
            InputError: the volume cannot be used, or there is no head in it.
        """
        # Only here: scipy takes time to import.
        from rastrainer.slicer.head.head_draft import find_skin
        from rastrainer.slicer.head.scenario_build import in_background
        from rastrainer.slicer.head.segment import show_segment
        from rastrainer.slicer.head.volume import volume_from_node

        volume = volume_from_node(volumeNode)
        found, skin, warnings = in_background(
            lambda tell: find_skin(volume, settings, tell), progress
        )
        node = self._node("vtkMRMLSegmentationNode", Role.HEAD_SEGMENT, "Head to be edited")
        show_segment(node, found)
        node.SetReferenceImageGeometryParameterFromVolumeNode(volumeNode)
        node.SetAttribute(PREVIEWED_ATTRIBUTE, volumeNode.GetID())
        node.SetAttribute(SETTINGS_ATTRIBUTE, repr(settings))
        model = self._node("vtkMRMLModelNode", Role.HEAD_PREVIEW, "Head as found")
        model.SetAndObservePolyData(trianglesPolyData(skin.vertices, skin.triangles))
        model.GetDisplayNode().SetColor(SKIN_COLOR)
        return warnings

    def segment(self, volumeNode: Any, settings: HeadSettings) -> Volume | None:
        """Return the segment of the head that is shown of a volume, None where none is.

        Raises:
            InputError: the head was found with other settings, or its segment cannot be used.
        """
        from rastrainer.slicer.head.segment import SEGMENT_NAME, volume_of_segment

        node = findNode(self._scene, "vtkMRMLSegmentationNode", Role.HEAD_SEGMENT)
        if node is None or node.GetAttribute(PREVIEWED_ATTRIBUTE) != volumeNode.GetID():
            return None
        if node.GetAttribute(SETTINGS_ATTRIBUTE) != repr(settings):
            raise InputError(
                _(
                    "The threshold or the cut has been changed since the head was found: find the "
                    "head again, or set it back."
                )
            )
        segment = node.GetSegmentation().GetSegmentIdBySegmentName(SEGMENT_NAME)
        return volume_of_segment(node, segment)

    def _node(self, className: str, role: str, name: str) -> Any:
        """Return a node that stands under no transform: what is found is where it is shown."""
        node = findOrAddNode(self._scene, className, role, name)
        node.SetAndObserveTransformNodeID(None)
        return node
