"""Loads a `.ui` file, and refuses in it what Slicer's Qt Designer would not know."""

from __future__ import annotations

import functools
import xml.etree.ElementTree as ElementTree

from PySide6 import QtCore, QtUiTools, QtWidgets

from Testing.slicer.host.members import members_of, module_of
from Testing.slicer.host.stand_ins import ctk, mrml

WIDGETS = {
    name: kind
    for module in (ctk, mrml)
    for name, kind in vars(module).items()
    if name.startswith(("ctk", "qMRML", "qSlicer"))
}


class QUiLoader(QtCore.QObject):
    """Makes the widgets of CTK and of Slicer, too, and connects them."""

    def load(self, device: QtCore.QIODevice, parent: QtWidgets.QWidget | None = None) -> object:
        content, enumerations, connections = _checked(bytes(device.readAll().data()))
        buffer = QtCore.QBuffer()
        buffer.setData(content)
        buffer.open(QtCore.QIODevice.OpenModeFlag.ReadOnly)
        widget = _loader().load(buffer, parent)
        for name, (key, value) in enumerations.items():
            _named(widget, name).setProperty(key, value)
        for connection in connections:
            _connect(widget, connection)
        return widget


class _Loader(QtUiTools.QUiLoader):
    def createWidget(
        self, class_name: str, parent: QtWidgets.QWidget | None = None, name: str = ""
    ) -> QtWidgets.QWidget:
        made = WIDGETS.get(class_name)
        if made is None:
            return super().createWidget(class_name, parent, name)
        widget = made(parent)
        widget.setObjectName(name)
        return widget


@functools.cache
def _loader() -> _Loader:
    """Return the loader of all files: a new loader looks for plugins first."""
    return _Loader()


@functools.cache
def _checked(content: bytes) -> tuple[bytes, dict[str, tuple[str, int]], list[dict[str, str]]]:
    """Return what Qt can read of a `.ui` file, and apart from it what only CTK knows.

    That is the enumerations, by the names of their widgets, and the connections.
    """
    root = ElementTree.fromstring(content)
    enumerations = {}
    for element in root.iter("widget"):
        check_widget(element)
        enumerations |= _take_enumerations(element)
    connections = [dict(_texts(item)) for item in root.iter("connection")]
    for element in root.findall("connections"):
        root.remove(element)
    return ElementTree.tostring(root), enumerations, connections


def check_widget(element: ElementTree.Element) -> None:
    """Check one widget of a `.ui` file."""
    class_name, name = element.get("class"), element.get("name")
    if class_name == "Line":  # Designer's name for a QFrame.
        return
    if module_of(class_name) is None:
        raise AttributeError(f"{name}: Slicer or the host has no {class_name}.")
    known = members_of(class_name).properties
    for item in element.findall("property"):
        if item.get("stdset") != "0" and item.get("name") not in known:
            raise AttributeError(f"{name}: {class_name} has no property {item.get('name')}.")


def _take_enumerations(element: ElementTree.Element) -> dict[str, tuple[str, int]]:
    """Take CTK's enumerations out of a widget: Qt cannot read those that Python defines."""
    made = WIDGETS.get(element.get("class"))
    taken = {}
    for item in element.findall("property"):
        text = item.findtext("set") or item.findtext("enum") or ""
        if text.startswith("ctk"):
            flags = [getattr(made, flag.rpartition("::")[2]) for flag in text.split("|")]
            taken[element.get("name")] = (item.get("name"), sum(flags))
            element.remove(item)
    return taken


def _connect(widget: QtWidgets.QWidget, connection: dict[str, str]) -> None:
    """Make one connection of the file."""
    sender, receiver = (_named(widget, connection[end]) for end in ("sender", "receiver"))
    signal, slot = connection["signal"], connection["slot"]
    slot_name = slot.partition("(")[0]
    if signal not in members_of(type(sender).__name__).signals:
        raise AttributeError(f"{type(sender).__name__} has no signal {signal}.")
    if slot_name not in members_of(type(receiver).__name__).methods:
        raise AttributeError(f"{type(receiver).__name__} has no slot {slot}.")
    getattr(sender, signal.partition("(")[0]).connect(getattr(receiver, slot_name))


def _named(widget: QtWidgets.QWidget, name: str) -> QtWidgets.QWidget:
    return widget if widget.objectName() == name else widget.findChild(QtCore.QObject, name)


def _texts(element: ElementTree.Element) -> list[tuple[str, str]]:
    return [(child.tag, child.text or "") for child in element if child.tag != "hints"]
