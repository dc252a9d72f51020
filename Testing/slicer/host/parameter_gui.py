"""Binds widgets to parameters, in both directions."""

from __future__ import annotations

from typing import Any

import slicer
import vtk

# Class of widget: the signal of a change, and how the value is read and written.
VALUE_OF = {
    "QLineEdit": ("textChanged(QString)", "text"),
    "QSpinBox": ("valueChanged(int)", "value"),
    "QDoubleSpinBox": ("valueChanged(double)", "value"),
    "QCheckBox": ("toggled(bool)", "checked"),
    "QPushButton": ("toggled(bool)", "checked"),
    "QSlider": ("valueChanged(int)", "value"),
    "QComboBox": ("currentTextChanged(QString)", "currentText"),
    "ctkComboBox": ("currentTextChanged(QString)", "currentText"),
    "ctkSliderWidget": ("valueChanged(double)", "value"),
    "ctkCollapsibleButton": ("contentsCollapsed(bool)", "collapsed"),
    "ctkPathLineEdit": ("currentPathChanged(QString)", "currentPath"),
    "qMRMLNodeComboBox": ("currentNodeChanged(vtkMRMLNode*)", None),
}


class Binding:
    """The bound widgets of one call of `connectGui`."""

    def __init__(self, wrapper: Any, ui: Any) -> None:
        self._wrapper = wrapper
        self._widgets: dict[str, Any] = {}
        for widget in vars(ui).values():
            name = widget.property("SlicerParameterName")
            if not name:
                continue
            if name not in wrapper.allParameters:
                raise ValueError(f"No parameter is called {name}.")
            parameter = wrapper.allParameters[name]
            if parameter.isNode:
                widget.nodeTypes = parameter.node_class_names()
            self._widgets[name] = widget
        self._isShowing = False
        self._show()
        self._slots = {name: self._slot(name) for name in self._widgets}
        for name, widget in self._widgets.items():
            widget.connect(VALUE_OF[widget.className()][0], self._slots[name])
        self._tag = wrapper.AddObserver(vtk.vtkCommand.ModifiedEvent, self._show)

    def close(self) -> None:
        """Release the widgets."""
        self._wrapper.RemoveObserver(self._tag)
        for name, widget in self._widgets.items():
            widget.disconnect(VALUE_OF[widget.className()][0], self._slots[name])

    def _slot(self, name: str) -> Any:
        def take() -> None:
            if not self._isShowing:
                setattr(self._wrapper, name, self._value(name))

        return take

    def _value(self, name: str) -> Any:
        widget = self._widgets[name]
        attribute = VALUE_OF[widget.className()][1]
        if attribute is None:
            return widget.currentNode()
        kind = self._wrapper.allParameters[name].kind
        value = getattr(widget, attribute)
        return value if isinstance(value, kind) else kind(value)

    def _show(self, *_event: Any) -> None:
        self._isShowing = True
        for name, widget in self._widgets.items():
            attribute = VALUE_OF[widget.className()][1]
            value = getattr(self._wrapper, name)
            if attribute is None:
                if widget.mrmlScene() is not None or slicer.mrmlScene is not None:
                    widget.setCurrentNode(value)
            elif getattr(widget, attribute) != value:
                setattr(widget, attribute, value if isinstance(value, (int, float)) else str(value))
        self._isShowing = False
