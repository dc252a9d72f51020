"""`slicer.app.layoutManager()`: a 3D view and three slice views; drawn on request."""

from __future__ import annotations

import functools
from typing import Any

import slicer
import vtk

from Testing.slicer.host.members import FACTS, Checked, members_of
from Testing.slicer.host.proxy import class_named
from Testing.slicer.host.views import SLICES, SliceView, ThreeDView, slice_logic

LAYOUTS_WITHOUT_3D = (
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpRedSliceView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpYellowSliceView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpGreenSliceView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpPlotView,
)

LAYOUTS_WITHOUT_SLICES = (
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUp3DView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpPlotView,
)


def _all_members(class_name: str) -> frozenset[str]:
    members = members_of(class_name)
    return members.properties | members.methods


class LayoutManager(Checked):
    """Stands in for `qSlicerLayoutManager`.

    Attributes:
        layout: number of the layout that is shown, no matter who has chosen it.
        threeDViewCount: number of 3D views in it.
        plotViewCount: number of plot views in it.
        tableViewCount: number of table views in it.
    """

    measured = frozenset(FACTS["slicer.app.layoutManager()"])
    title = "slicer.app.layoutManager()"

    def __init__(self, scene: Any, application_logic: Any) -> None:
        self._scene = scene
        self._logic = application_logic
        self._layouts = slicer.vtkMRMLLayoutLogic()
        self._layouts.SetMRMLApplicationLogic(application_logic)
        self._layouts.SetMRMLScene(scene)
        self.setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
        self._plots: dict[str, Any] = {}
        # Slicer has the nodes of its slice views from its start.
        self._slice_logics = {name: slice_logic(scene, application_logic, name) for name in SLICES}

    @functools.cached_property
    def _three_d(self) -> ThreeDView:
        return ThreeDView(self._scene, self._logic)

    @functools.cached_property
    def _slices(self) -> dict[str, SliceView]:
        return {name: SliceView(self._logic, each) for name, each in self._slice_logics.items()}

    def show_views(self) -> None:
        """Make the views, which follow the scene from then on, as Slicer's do from its start."""
        self.three_d_view_of_host()
        self.slice_views_of_host()

    @property
    def layout(self) -> int:
        return self._layouts.GetLayoutNode().GetViewArrangement()

    @property
    def threeDViewCount(self) -> int:
        return len(self._views("vtkMRMLViewNode"))

    @property
    def plotViewCount(self) -> int:
        return len(self._views("vtkMRMLPlotViewNode"))

    @property
    def tableViewCount(self) -> int:
        return len(self._views("vtkMRMLTableViewNode"))

    def setLayout(self, layout: int) -> None:
        self._layouts.GetLayoutNode().SetViewArrangement(layout)

    def plotWidget(self, index: int) -> Any:
        if index >= self.plotViewCount:
            return None
        node = self._views("vtkMRMLPlotViewNode")[index]
        if node.GetID() not in self._plots:
            plot = class_named("qMRMLPlotWidget")()
            plot.setMRMLScene(self._scene)
            plot.setMRMLPlotViewNode(node)
            self._plots[node.GetID()] = plot
        return self._plots[node.GetID()]

    def shown_tables_of_host(self) -> list[str]:
        """Return the names of the tables that are visible in the layout."""
        tables = [view.GetTableNode() for view in self._views("vtkMRMLTableViewNode")]
        return [table.GetName() for table in tables if table is not None]

    def _views(self, class_name: str) -> list[Any]:
        """Return the view nodes of a class that the layout shows."""
        nodes = self._layouts.GetViewNodes()
        shown = [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]
        return [node for node in shown if node.IsA(class_name)]

    def threeDWidget(self, index: int) -> ThreeDWidget | None:
        return ThreeDWidget(self) if index == 0 else None

    @property
    def _has_slices(self) -> bool:
        return self.layout not in LAYOUTS_WITHOUT_SLICES

    @property
    def is_3d_shown(self) -> bool:
        """Whether the layout has a 3D view."""
        return self.layout not in LAYOUTS_WITHOUT_3D

    def sliceViewNames(self) -> tuple[str, ...]:
        return tuple(SLICES)

    def sliceWidget(self, name: str) -> SliceWidget | None:
        return SliceWidget(self._slices[name], self._has_slices) if name in SLICES else None

    def mrmlSliceLogics(self) -> vtk.vtkCollection:
        logics = vtk.vtkCollection()
        for logic in self._slice_logics.values():
            logics.AddItem(logic)
        return logics

    def resetThreeDViews(self) -> None:
        self._three_d.look_at_everything()

    def resetSliceViews(self) -> None:
        """Center each slice view on its content, which moves its slice."""
        for logic in self._slice_logics.values():
            width, height, _ = logic.GetSliceNode().GetDimensions()
            logic.FitSliceToAll(width, height)

    def three_d_view_of_host(self) -> ThreeDView:
        """Return the 3D view, to draw it."""
        return self._three_d

    def slice_views_of_host(self) -> list[SliceView]:
        """Return the slice views, to draw them."""
        return list(self._slices.values())

    def close(self) -> None:
        """Release the scene."""
        views = [self.__dict__.get("_three_d"), *self.__dict__.get("_slices", {}).values()]
        for view in views:
            if view is not None:
                view.close()


class ThreeDWidget(Checked):
    """Stands in for `qMRMLThreeDWidget`.

    Attributes:
        visible: the layout has it; also where the window is minimized.
    """

    measured = _all_members("qMRMLThreeDWidget")
    title = "qMRMLThreeDWidget"

    def __init__(self, layout: LayoutManager) -> None:
        self.visible = layout.is_3d_shown
        self._layout = layout

    def mrmlViewNode(self) -> Any:
        return self._layout.three_d_view_of_host().node

    def threeDView(self) -> ThreeDViewWidget:
        return ThreeDViewWidget(self._layout.three_d_view_of_host())


class ThreeDViewWidget(Checked):
    """Stands in for `qMRMLThreeDView`."""

    measured = _all_members("qMRMLThreeDView")
    title = "qMRMLThreeDView"

    def __init__(self, view: ThreeDView) -> None:
        self._view = view

    def mrmlViewNode(self) -> Any:
        return self._view.node

    def cameraNode(self) -> Any:
        return self._view.camera_node()

    def renderWindow(self) -> Any:
        return self._view.window

    def resetFocalPoint(self) -> None:
        self._view.look_at_everything()

    def resetCamera(self, *_more: Any) -> None:
        self._view.look_at_everything()

    def forceRender(self) -> None:
        """Pictures are always drawn anew here."""

    def scheduleRender(self) -> None:
        """Pictures are always drawn anew here."""


class SliceWidget(Checked):
    """Stands in for `qMRMLSliceWidget`.

    Attributes:
        visible: the layout has slice views; also where the window is minimized.
    """

    measured = _all_members("qMRMLSliceWidget")
    title = "qMRMLSliceWidget"

    def __init__(self, view: SliceView, is_visible: bool) -> None:
        self._view = view
        self.visible = is_visible

    def sliceLogic(self) -> Any:
        return self._view.logic

    def mrmlSliceNode(self) -> Any:
        return self._view.node

    def mrmlSliceCompositeNode(self) -> Any:
        return self._view.logic.GetSliceCompositeNode()

    def fitSliceToBackground(self) -> None:
        """Pictures of the slices are always fitted here."""
