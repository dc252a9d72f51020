"""The head that is found in a volume, shown before a scenario is made, to accept or to change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.program.child_process import Run
from rastrainer.slicer.scene.nodes import Role, findNode, findOrAddNode, nodesOf
from rastrainer.slicer.scene.scenario_nodes import SKIN_COLOR
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress

if TYPE_CHECKING:
    from rastrainer.head.mesh import HeadMesh
    from rastrainer.slicer.head.volume import HeadBody, HeadSettings, SegmentImage

FIND_SKIN = "rastrainer.slicer.head.head_draft:findSkin"
SEGMENTATION, MODEL = "vtkMRMLSegmentationNode", "vtkMRMLModelNode"
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


def showHead(run: Run, volumeNode: Any, settings: HeadSettings, progress: Progress) -> list[str]:
    """Show the head in a `vtkMRMLScalarVolumeNode`; return warnings, one sentence each.

    That is a model of it, and a segment that the Segment Editor may change.
    """
    from rastrainer.slicer.head.volume import showSegment

    found, skin, warnings = findSkin(run, volumeNode, settings, progress)
    scene = volumeNode.GetScene()
    draft = findOrAddNode(scene, SEGMENTATION, Role.HEAD_SEGMENT, "Head to be edited")
    model = findOrAddNode(scene, MODEL, Role.HEAD_PREVIEW, "Head as found")
    for node in (draft, model):
        # It is shown where it was found.
        node.SetAndObserveTransformNodeID(None)
    showSegment(draft, found)
    draft.SetReferenceImageGeometryParameterFromVolumeNode(volumeNode)
    draft.SetAttribute(PREVIEWED_ATTRIBUTE, volumeNode.GetID())
    draft.SetAttribute(SETTINGS_ATTRIBUTE, repr(settings))
    model.SetAndObservePolyData(meshPolyData(skin))
    model.GetDisplayNode().SetColor(SKIN_COLOR)
    for node in (draft, model):
        node.SetDisplayVisibility(True)
    return warnings


def hideHead(scene: Any, volumeNode: Any) -> None:
    """Hide the draft, and a rendering of its volume: the result is shown instead."""
    for className, role in ((SEGMENTATION, Role.HEAD_SEGMENT), (MODEL, Role.HEAD_PREVIEW)):
        for node in nodesOf(scene, className, role):
            node.SetDisplayVisibility(False)
    for index in range(volumeNode.GetNumberOfDisplayNodes()):
        display = volumeNode.GetNthDisplayNode(index)
        if display is not None and display.IsA("vtkMRMLVolumeRenderingDisplayNode"):
            display.SetVisibility(False)


def editedHead(volumeNode: Any, settings: HeadSettings) -> SegmentImage | None:
    """Return the segment of the head that is shown of a volume, None where none is."""
    from rastrainer.slicer.head.volume import SEGMENT_NAME, readSegment

    node = findNode(volumeNode.GetScene(), SEGMENTATION, Role.HEAD_SEGMENT)
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
