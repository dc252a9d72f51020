"""`slicer.parameterNodeWrapper`: typed parameters over a node of the scene.

Only documented types that are used: str, int, float, bool, Path, Enum and nodes (one class, or an
`Optional[Union[...]]` of several), `Annotated` with a default or a check, and widgets bound by
their property `SlicerParameterName`. It refuses what Slicer refuses (measured in 5.13): a node
class that is abstract, as soon as a widget is bound to it, and a `Union` without room for None.
"""

from __future__ import annotations

import enum
import typing
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from Testing.slicer.host.parameter_gui import Binding


def parameterNodeWrapper(kind: type) -> type:
    """Have a class with annotations store its values in a node."""
    hints = typing.get_type_hints(kind, include_extras=True)
    namespace: dict[str, Any] = {"__doc__": kind.__doc__, "allParameters": {}}
    for name, hint in hints.items():
        parameter = Parameter(name, hint, vars(kind).get(name))
        namespace["allParameters"][name] = parameter
        namespace[name] = parameter
    return type(kind.__name__, (ParameterNode,), namespace)


class Parameter:
    """One typed parameter: a descriptor."""

    def __init__(self, name: str, hint: Any, default: Any) -> None:
        self.name = name
        self.kind = hint
        self.checks: list[Any] = []
        if typing.get_origin(hint) is typing.Annotated:
            self.kind, *extras = typing.get_args(hint)
            self.checks = [extra for extra in extras if not isinstance(extra, Default)]
            default = next((item.value for item in extras if isinstance(item, Default)), default)
        arguments = typing.get_args(self.kind)
        self.kinds = tuple(item for item in arguments if item is not type(None)) or (self.kind,)
        self.kind = self.kinds[0]
        self.isNode = self.kind.__name__.startswith("vtkMRML")
        self.isOptional = type(None) in arguments or (self.isNode and not arguments)
        self.default = self._first_value() if default is None else default

    def __get__(self, owner: ParameterNode | None, _kind: type) -> Any:
        if owner is None:
            return self
        node = owner.parameterNode
        if self.isNode:
            return node.GetNodeReference(self.name)
        return self._parse(node.GetParameter(self.name))

    def __set__(self, owner: ParameterNode, value: Any) -> None:
        node = owner.parameterNode
        if self.isNode:
            if value is not None and not isinstance(value, self.kinds):
                names = " or ".join(kind.__name__ for kind in self.kinds)
                raise ValueError(f"{self.name} is no {names}: {value!r}")
            node.SetNodeReferenceID(self.name, value.GetID() if value is not None else None)
            return
        if self.kind is float and type(value) is int:
            value = float(value)
        if not isinstance(value, self.kind) or (self.kind is int and isinstance(value, bool)):
            raise ValueError(f"{self.name} is no {self.kind.__name__}: {value!r}")
        for check in self.checks:
            check.check(value)
        node.SetParameter(self.name, value.name if isinstance(value, enum.Enum) else str(value))

    def write_default(self, node: Any) -> None:
        """Write the default, if the node has no value yet.

        Raises:
            ValueError: a `Union` of nodes leaves no room for None.
        """
        if self.default is None and not self.isOptional:
            raise ValueError("Unable to write value 'None'")
        if not self.isNode and not node.GetParameter(self.name):
            value = self.default
            node.SetParameter(self.name, value.name if isinstance(value, enum.Enum) else str(value))

    def node_class_names(self) -> list[str]:
        """Return the classes' names as Slicer does: it makes a node of each and asks it.

        Raises:
            TypeError: one of the classes is abstract.
        """
        return [kind().GetClassName() for kind in self.kinds]

    def _first_value(self) -> Any:
        if self.isNode:
            return None
        if issubclass(self.kind, enum.Enum):
            return next(iter(self.kind))
        return self.kind()

    def _parse(self, text: str) -> Any:
        if self.kind is bool:
            return text == "True"
        if issubclass(self.kind, enum.Enum):
            return self.kind[text]
        return self.kind(text)


class ParameterNode:
    """Base of what `parameterNodeWrapper` makes."""

    allParameters: dict[str, Parameter]

    def __init__(self, node: Any) -> None:
        object.__setattr__(self, "parameterNode", node)
        object.__setattr__(self, "_bindings", {})
        for parameter in self.allParameters.values():
            parameter.write_default(node)

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
        """Undo `connectGui`."""
        if tag in self._bindings:
            self._bindings.pop(tag).close()

    def AddObserver(self, event: Any, callback: Any, priority: float = 0.0) -> int:
        return self.parameterNode.AddObserver(event, callback, priority)

    def RemoveObserver(self, tag: int) -> None:
        self.parameterNode.RemoveObserver(tag)

    def HasObserver(self, event: Any, callback: Any) -> bool:
        return self.parameterNode.HasObserver(event, callback)

    def StartModify(self) -> int:
        return self.parameterNode.StartModify()

    def EndModify(self, was: int) -> None:
        self.parameterNode.EndModify(was)


def make_module() -> ModuleType:
    """Return the module `slicer.parameterNodeWrapper`."""
    module = ModuleType("slicer.parameterNodeWrapper")
    module.parameterNodeWrapper = parameterNodeWrapper
    for kind in (WithinRange, Default, Choice):
        setattr(module, kind.__name__, kind)
    return module


@dataclass(frozen=True)
class Default:
    """The value that a new node has."""

    value: Any


@dataclass(frozen=True)
class WithinRange:
    """The value lies from `minimum` to `maximum`."""

    minimum: float
    maximum: float

    def check(self, value: float) -> None:
        if not self.minimum <= value <= self.maximum:
            raise ValueError(f"{value} is not within {self.minimum} to {self.maximum}.")


@dataclass(frozen=True)
class Choice:
    """The value is one of these."""

    choices: tuple

    def check(self, value: Any) -> None:
        if value not in self.choices:
            raise ValueError(f"{value!r} is none of {self.choices}.")
