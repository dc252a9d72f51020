"""`slicer.app.layoutManager()`: a 3D view and three slice views; made when they are asked for."""

from __future__ import annotations

import functools
from typing import Any

import slicer
import vtk

from Testing.slicer.host.checked import Checked
from Testing.slicer.host.members import FACTS, members_of
from Testing.slicer.host.qt_module import class_named
from Testing.slicer.host.views import SLICES, SliceView, ThreeDView

PLOT_LAYOUTS = (
    slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalPlotView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpPlotView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpPlotTableView,
    slicer.vtkMRMLLayoutNode.SlicerLayoutOneUpPlotView,
)


def _all_members(class_name: str) -> frozenset[str]:
    members = members_of(class_name)
    return members.properties | members.methods


class LayoutManager(Checked):
    """Stands in for `qSlicerLayoutManager`.

    Attributes:
        layout: the layout that was chosen; but for the plot the views stay the same here.
        threeDViewCount: number of 3D views.
        plotViewCount: number of plot views.
    """

    measured = frozenset(FACTS["slicer.app.layoutManager()"])
    title = "slicer.app.layoutManager()"

    def __init__(self, scene: Any, application_logic: Any) -> None:
        self._scene = scene
        self._logic = application_logic
        self.layout = slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView
        self.threeDViewCount = 1
        self.plotViewCount = 0
        self._plots: list[Any] = []

    @functools.cached_property
    def _three_d(self) -> ThreeDView:
        return ThreeDView(self._scene, self._logic)

    @functools.cached_property
    def _slices(self) -> dict[str, SliceView]:
        return {name: SliceView(self._scene, self._logic, name) for name in SLICES}

    def setLayout(self, layout: int) -> None:
        self.layout = layout
        if layout in PLOT_LAYOUTS and not self._plots:
            plot = class_named("qMRMLPlotWidget")()
            plot.setMRMLScene(self._scene)
            plot.setMRMLPlotViewNode(self._plot_view_node())
            self._plots.append(plot)
        self.plotViewCount = len(self._plots) if layout in PLOT_LAYOUTS else 0

    def plotWidget(self, index: int) -> Any:
        return self._plots[index] if index < self.plotViewCount else None

    def threeDWidget(self, index: int) -> ThreeDWidget | None:
        return ThreeDWidget(self._three_d) if index == 0 else None

    def sliceViewNames(self) -> tuple[str, ...]:
        return tuple(SLICES)

    def sliceWidget(self, name: str) -> SliceWidget | None:
        return SliceWidget(self._slices[name]) if name in SLICES else None

    def mrmlSliceLogics(self) -> vtk.vtkCollection:
        logics = vtk.vtkCollection()
        for view in self._slices.values():
            logics.AddItem(view.logic)
        return logics

    def resetThreeDViews(self) -> None:
        self._three_d.look_at_everything()

    def resetSliceViews(self) -> None:
        """Pictures of the slices are always fitted here."""

    def _plot_view_node(self) -> Any:
        node = slicer.vtkMRMLPlotViewNode()
        node.SetSingletonTag("PlotView1")
        node.SetLayoutName("PlotView1")
        node.SetName("PlotView1")
        return self._scene.AddNode(node)

    def three_d_view_of_host(self) -> ThreeDView:
        """Return the 3D view, to draw it."""
        return self._three_d

    def slice_views_of_host(self) -> list[SliceView]:
        """Return the slice views, to draw them."""
        return list(self._slices.values())

    def close(self) -> None:
        """Let go of the scene."""
        views = [self.__dict__.get("_three_d"), *self.__dict__.get("_slices", {}).values()]
        for view in views:
            if view is not None:
                view.close()


class ThreeDWidget(Checked):
    """Stands in for `qMRMLThreeDWidget`."""

    measured = _all_members("qMRMLThreeDWidget")
    title = "qMRMLThreeDWidget"

    def __init__(self, view: ThreeDView) -> None:
        self._view = view

    def mrmlViewNode(self) -> Any:
        return self._view.node

    def threeDView(self) -> ThreeDViewWidget:
        return ThreeDViewWidget(self._view)


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
    """Stands in for `qMRMLSliceWidget`."""

    measured = _all_members("qMRMLSliceWidget")
    title = "qMRMLSliceWidget"

    def __init__(self, view: SliceView) -> None:
        self._view = view

    def sliceLogic(self) -> Any:
        return self._view.logic

    def mrmlSliceNode(self) -> Any:
        return self._view.node

    def mrmlSliceCompositeNode(self) -> Any:
        return self._view.logic.GetSliceCompositeNode()

    def fitSliceToBackground(self) -> None:
        """Pictures of the slices are always fitted here."""
