"""Slicer's widgets that show a part of the scene, and the combo box in which a node is chosen."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

import shiboken6
import slicer
import vtk
from PySide6 import QtCore, QtGui, QtWidgets


class qMRMLWidget(QtWidgets.QWidget):
    """Hands the scene to all its children, as the connections of a `.ui` file do."""

    mrmlSceneChanged = QtCore.Signal(object)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._scene: Any = None

    def mrmlScene(self) -> Any:
        return self._scene

    def setMRMLScene(self, scene: Any) -> None:
        self._scene = scene
        self.mrmlSceneChanged.emit(scene)


class qSlicerScriptedLoadableModuleWidget(qMRMLWidget):
    """The frame of a module's widgets."""

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._isEntered = False
        QtWidgets.QVBoxLayout(self)

    def enter(self) -> None:
        self._isEntered = True

    def exit(self) -> None:
        self._isEntered = False

    isEntered = QtCore.Property(bool, lambda self: self._isEntered)


class qSlicerMainWindow(QtWidgets.QMainWindow):
    """The window of the application; `slicer.util.mainWindow` finds it by its name.

    The host sets its list of modules, and what draws a picture of it.
    """

    selector: Any = None
    picture: Callable[[], QtGui.QPixmap]

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("qSlicerMainWindow")

    def grab(self, *_rectangle: object) -> QtGui.QPixmap:
        """Return a picture of the window."""
        return self.picture()

    def moduleSelector(self) -> Any:
        return self.selector


def weakly(method: Callable[..., None]) -> Callable[..., None]:
    """Return an observer that calls a widget's method `(event, object or None)` while it lives.

    VTK would keep the observers of a dead widget alive.
    """
    reference = weakref.WeakMethod(method)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def observe(_caller: Any, event: str, call_data: Any = None) -> None:
        alive = reference()
        if alive is not None and shiboken6.isValid(alive.__self__):
            alive(event, call_data)

    return observe


def _stored(name: str, kind: Any) -> QtCore.Property:
    """Return a property that lies in `_values`."""

    def get(self: qMRMLNodeComboBox) -> Any:
        return self._values[name]

    def put(self: qMRMLNodeComboBox, value: Any) -> None:
        self._values[name] = list(value) if isinstance(value, tuple) else value
        self._fill()

    return QtCore.Property(kind, get, put)


class qMRMLNodeComboBox(QtWidgets.QWidget):
    """Lists the nodes of some classes; follows the scene as nodes come, go and are renamed."""

    currentNodeChanged = QtCore.Signal(object)
    currentNodeIDChanged = QtCore.Signal(str)
    nodeAdded = QtCore.Signal(object)
    nodeAddedByUser = QtCore.Signal(object)
    nodeAboutToBeRemoved = QtCore.Signal(object)
    nodeActivated = QtCore.Signal(object)
    mrmlSceneChanged = QtCore.Signal(object)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._combo = QtWidgets.QComboBox(self)
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._combo)
        self._scene: Any = None
        self._tags: list[int] = []
        self._current: str = ""
        self._values: dict[str, Any] = {
            "nodeTypes": [],
            "showHidden": False,
            "showChildNodeTypes": True,
            "hideChildNodeTypes": [],
            "baseName": "",
            "noneEnabled": False,
            "addEnabled": True,
            "removeEnabled": True,
            "editEnabled": False,
            "renameEnabled": False,
            "selectNodeUponCreation": True,
            "noneDisplay": "None",
        }
        self._combo.activated.connect(self._choose)

    def mrmlScene(self) -> Any:
        return self._scene

    def setMRMLScene(self, scene: Any) -> None:
        if scene is self._scene:
            return
        for tag in self._tags:
            self._scene.RemoveObserver(tag)
        self._tags = []
        self._scene = scene
        if scene is not None:
            events = (
                scene.NodeAddedEvent,
                scene.NodeAboutToBeRemovedEvent,
                scene.NodeRemovedEvent,
                scene.EndBatchProcessEvent,
                scene.EndCloseEvent,
            )
            self._tags = tags = [scene.AddObserver(each, weakly(self._follow)) for each in events]
            self.destroyed.connect(lambda: [scene.RemoveObserver(tag) for tag in tags])
        self._fill()
        self.mrmlSceneChanged.emit(scene)

    def nodes(self) -> list[Any]:
        """Return the nodes among which one can be chosen."""
        if self._scene is None:
            return []
        kinds, find = self._values["nodeTypes"], slicer.util.getNodesByClass
        found = [node for kind in kinds for node in find(kind, self._scene)]
        return [node for node in found if self._is_offered(node)]

    def _is_offered(self, node: Any) -> bool:
        isShown = self._values["showHidden"] or not node.GetHideFromEditors()
        return isShown and node.GetClassName() not in self._values["hideChildNodeTypes"]

    def currentNode(self) -> Any:
        return self._scene.GetNodeByID(self._current) if self._scene and self._current else None

    def setCurrentNode(self, node: Any) -> None:
        self.setCurrentNodeID(node.GetID() if node is not None else "")

    def setCurrentNodeID(self, node_id: str) -> None:
        ids = [node.GetID() for node in self.nodes()]
        wanted = node_id if node_id in ids else ""
        if not wanted and not self._values["noneEnabled"] and ids:
            wanted = self._current if self._current in ids else ids[0]
        isNew = wanted != self._current
        self._current = wanted
        self._fill_combo()
        if isNew:
            self.currentNodeIDChanged.emit(wanted)
            self.currentNodeChanged.emit(self.currentNode())

    def _follow(self, event: str, node: Any) -> None:
        if node is not None and not any(node.IsA(name) for name in self._values["nodeTypes"]):
            return
        if event == "NodeAboutToBeRemovedEvent":
            self.nodeAboutToBeRemoved.emit(node)
            return
        if self._scene is not None and not self._scene.IsBatchProcessing():
            self._fill()

    def _fill(self) -> None:
        self.setCurrentNodeID(self._current)

    def _fill_combo(self) -> None:
        self._combo.clear()
        if self._values["noneEnabled"] or not self.nodes():
            self._combo.addItem(self._values["noneDisplay"], "")
        for node in self.nodes():
            self._combo.addItem(node.GetName(), node.GetID())
        self._combo.setCurrentIndex(max(self._combo.findData(self._current), 0))

    def _choose(self, index: int) -> None:
        self.setCurrentNodeID(self._combo.itemData(index))
        self.nodeActivated.emit(self.currentNode())

    currentNodeID = QtCore.Property(str, lambda self: self._current, setCurrentNodeID)
    nodeTypes = _stored("nodeTypes", "QStringList")
    showHidden = _stored("showHidden", bool)
    showChildNodeTypes = _stored("showChildNodeTypes", bool)
    hideChildNodeTypes = _stored("hideChildNodeTypes", "QStringList")
    baseName = _stored("baseName", str)
    noneEnabled = _stored("noneEnabled", bool)
    addEnabled = _stored("addEnabled", bool)
    removeEnabled = _stored("removeEnabled", bool)
    editEnabled = _stored("editEnabled", bool)
    renameEnabled = _stored("renameEnabled", bool)
    selectNodeUponCreation = _stored("selectNodeUponCreation", bool)
    noneDisplay = _stored("noneDisplay", str)
