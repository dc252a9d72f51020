"""Loads a `.ui` file, and refuses in it what Slicer's Qt Designer would not know."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree

from PySide6 import QtCore, QtUiTools, QtWidgets

from Testing.slicer.host.members import members_of, module_of


class QUiLoader(QtUiTools.QUiLoader):
    """Makes the widgets of CTK and of Slicer, too."""

    def load(self, device: QtCore.QIODevice, parent: QtWidgets.QWidget | None = None) -> object:
        tree = ElementTree.fromstring(bytes(device.readAll().data()))
        for element in tree.iter("widget"):
            check_widget(element)
        device.seek(0)
        return super().load(device, parent)

    def createWidget(
        self, class_name: str, parent: QtWidgets.QWidget | None = None, name: str = ""
    ) -> QtWidgets.QWidget:
        from Testing.slicer.host import stand_ins

        made = getattr(stand_ins, class_name, None)
        if made is None:
            return super().createWidget(class_name, parent, name)
        widget = made(parent)
        widget.setObjectName(name)
        return widget


def check_widget(element: ElementTree.Element) -> None:
    """Check one widget of a `.ui` file.

    Raises:
        AttributeError: its class, or one of its properties, is not in Slicer.
    """
    class_name, name = element.get("class"), element.get("name")
    if class_name == "Line":  # Designer's name for a QFrame.
        return
    if module_of(class_name) is None:
        raise AttributeError(f"{name}: Slicer or the host has no {class_name}.")
    known = members_of(class_name).properties
    for item in element.findall("property"):
        if item.get("stdset") != "0" and item.get("name") not in known:
            raise AttributeError(f"{name}: {class_name} has no property {item.get('name')}.")
