"""`slicer.app.layoutManager()`: a 3D view and three slice views; drawn on request."""

from __future__ import annotations

import functools
from typing import Any

import slicer

from Testing.slicer.host.members import FACTS, Checked, members_of
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


class ViewWidget(Checked):
    """Stands in for the widget of a view by some of its members.

    It is visible if the layout has it, also where the window is minimized.
    """

    def __init__(self, class_name: str, **offered: Any) -> None:
        members = members_of(class_name)
        measured = members.properties | members.methods
        vars(self).update(measured=measured, title=class_name, **offered)


class LayoutManager(Checked):
    """Stands in for `qSlicerLayoutManager`."""

    measured = frozenset(FACTS["slicer.app.layoutManager()"])
    title = "slicer.app.layoutManager()"

    def __init__(self, scene: Any, application_logic: Any) -> None:
        self._scene = scene
        self._logic = application_logic
        self._layouts = slicer.vtkMRMLLayoutLogic()
        self._layouts.SetMRMLApplicationLogic(application_logic)
        self._layouts.SetMRMLScene(scene)
        self.setLayout(slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
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

    def plotWidget(self, index: int) -> ViewWidget | None:
        nodes = self._views("vtkMRMLPlotViewNode")
        if index >= len(nodes):
            return None
        return ViewWidget("qMRMLPlotWidget", mrmlPlotViewNode=lambda: nodes[index])

    def shown_tables_of_host(self) -> list[str]:
        """Return the names of the tables that are visible in the layout."""
        tables = [view.GetTableNode() for view in self._views("vtkMRMLTableViewNode")]
        return [table.GetName() for table in tables if table is not None]

    def _views(self, class_name: str) -> list[Any]:
        """Return the view nodes of a class that the layout shows."""
        nodes = self._layouts.GetViewNodes()
        shown = [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]
        return [node for node in shown if node.IsA(class_name)]

    def threeDWidget(self, index: int) -> ViewWidget | None:
        is_visible = self.layout not in LAYOUTS_WITHOUT_3D
        return ViewWidget("qMRMLThreeDWidget", visible=is_visible) if index == 0 else None

    def sliceViewNames(self) -> tuple[str, ...]:
        return tuple(SLICES)

    def sliceWidget(self, name: str) -> ViewWidget | None:
        if name not in SLICES:
            return None
        logic = self._slices[name].logic
        return ViewWidget(
            "qMRMLSliceWidget",
            visible=self.layout not in LAYOUTS_WITHOUT_SLICES,
            sliceLogic=lambda: logic,
            mrmlSliceCompositeNode=logic.GetSliceCompositeNode,
        )

    def resetThreeDViews(self) -> None:
        self._three_d.look_at_everything()

    def three_d_view_of_host(self) -> ThreeDView:
        return self._three_d

    def slice_views_of_host(self) -> list[SliceView]:
        return list(self._slices.values())

    def close(self) -> None:
        views = [self.__dict__.get("_three_d"), *self.__dict__.get("_slices", {}).values()]
        for view in views:
            if view is not None:
                view.close()
