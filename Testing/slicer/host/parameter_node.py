"""`slicer.parameterNodeWrapper`: typed parameters over a node of the scene, and bound widgets.

Only parameters that are nodes are offered (one class, or an `Optional[Union[...]]` of several), and
widgets bound by their property `SlicerParameterName`. It refuses what Slicer refuses (measured in
5.13): a node class that is abstract, as soon as a widget is bound to it, and a `Union` without room
for None.
"""

from __future__ import annotations

import typing
from types import ModuleType
from typing import Any

import slicer
import vtk

CHANGED = "currentNodeChanged(vtkMRMLNode*)"


def parameterNodeWrapper(kind: type) -> type:
    """Have a class with annotations store its values in a node."""
    parameters = {name: Parameter(name, hint) for name, hint in typing.get_type_hints(kind).items()}
    namespace = {"__doc__": kind.__doc__, "allParameters": parameters, **parameters}
    return type(kind.__name__, (ParameterNode,), namespace)


class Parameter:
    """One node of the scene: a descriptor."""

    def __init__(self, name: str, hint: Any) -> None:
        self.name = name
        arguments = typing.get_args(hint)
        self.kinds = tuple(item for item in arguments if item is not type(None)) or (hint,)
        if not all(kind.__name__.startswith("vtkMRML") for kind in self.kinds):
            raise NotImplementedError(
                f"The host offers nodes alone, not {hint}, as parameters yet."
            )
        if arguments and type(None) not in arguments:
            raise ValueError("Unable to write value 'None'")

    def __get__(self, owner: ParameterNode | None, _kind: type) -> Any:
        return self if owner is None else owner.parameterNode.GetNodeReference(self.name)

    def __set__(self, owner: ParameterNode, value: Any) -> None:
        if value is not None and not isinstance(value, self.kinds):
            names = " or ".join(kind.__name__ for kind in self.kinds)
            raise ValueError(f"{self.name} is no {names}: {value!r}")
        node_id = value.GetID() if value is not None else None
        owner.parameterNode.SetNodeReferenceID(self.name, node_id)


class ParameterNode:
    """Base of what `parameterNodeWrapper` makes."""

    allParameters: dict[str, Parameter]

    def __init__(self, node: Any) -> None:
        object.__setattr__(self, "parameterNode", node)
        object.__setattr__(self, "_bindings", {})

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self.allParameters:
            raise AttributeError(f"{type(self).__name__} has no parameter {name}.")
        super().__setattr__(name, value)

    def connectGui(self, ui: Any) -> int:
        """Bind the widgets that name a parameter; return a number for `disconnectGui`."""
        tag = len(self._bindings) + 1
        self._bindings[tag] = Binding(self, ui)
        return tag

    def disconnectGui(self, tag: int) -> None:
        if tag in self._bindings:
            self._bindings.pop(tag).close()


class Binding:
    """The bound widgets of one call of `connectGui`, in both directions."""

    def __init__(self, wrapper: ParameterNode, ui: Any) -> None:
        self._wrapper = wrapper
        self._slots: list[tuple[str, Any, Any]] = []
        self._is_showing = False
        for widget in vars(ui).values():
            name = widget.property("SlicerParameterName")
            if not name:
                continue
            if name not in wrapper.allParameters:
                raise ValueError(f"No parameter is called {name}.")
            # As Slicer does, which makes a node of each class and asks it: none may be abstract.
            kinds = wrapper.allParameters[name].kinds
            widget.nodeTypes = [kind().GetClassName() for kind in kinds]
            self._slots.append((name, widget, self._slot(name, widget)))
        self._show()
        for _name, widget, slot in self._slots:
            widget.connect(CHANGED, slot)
        node = wrapper.parameterNode
        self._tag = node.AddObserver(vtk.vtkCommand.ModifiedEvent, self._show)

    def close(self) -> None:
        self._wrapper.parameterNode.RemoveObserver(self._tag)
        for _name, widget, slot in self._slots:
            widget.disconnect(CHANGED, slot)

    def _slot(self, name: str, widget: Any) -> Any:
        def take() -> None:
            if not self._is_showing:
                setattr(self._wrapper, name, widget.currentNode())

        return take

    def _show(self, *_event: Any) -> None:
        self._is_showing = True
        for name, widget, _slot in self._slots:
            if widget.mrmlScene() is not None or slicer.mrmlScene is not None:
                widget.setCurrentNode(getattr(self._wrapper, name))
        self._is_showing = False


def make_module() -> ModuleType:
    module = ModuleType("slicer.parameterNodeWrapper")
    module.parameterNodeWrapper = parameterNodeWrapper
    return module
