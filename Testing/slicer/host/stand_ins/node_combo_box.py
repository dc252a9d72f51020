"""The combo box in which a node of the scene is chosen."""

from __future__ import annotations

from typing import Any

from PySide6 import QtCore, QtWidgets

from Testing.slicer.host.stand_ins.observing import unobserving, weakly


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
            self._tags = [scene.AddObserver(event, weakly(self._follow)) for event in events]
            self.destroyed.connect(unobserving(scene, self._tags))
        self._fill()
        self.mrmlSceneChanged.emit(scene)

    def nodes(self) -> list[Any]:
        """Return the nodes among which one can be chosen."""
        if self._scene is None:
            return []
        found = []
        for name in self._values["nodeTypes"]:
            nodes = self._scene.GetNodesByClass(name)
            nodes.UnRegister(None)
            found += [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]
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

    def addNode(self, class_name: str = "") -> Any:
        name = self._values["baseName"] or "Node"
        made = self._scene.AddNewNodeByClass(class_name or self._values["nodeTypes"][0], name)
        if self._values["selectNodeUponCreation"]:
            self.setCurrentNode(made)
        self.nodeAddedByUser.emit(made)
        return made

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
