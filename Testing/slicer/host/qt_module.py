"""The modules `qt` and `ctk`, and Slicer's widgets, made of what the measurement tells."""

from __future__ import annotations

import functools
from types import ModuleType
from typing import Any

from PySide6 import QtCore, QtGui, QtUiTools, QtWidgets

from Testing.slicer.host import stand_ins
from Testing.slicer.host.constants import QtConstants
from Testing.slicer.host.members import members_of, module_of
from Testing.slicer.host.proxy import Proxy, make_class


@functools.cache
def class_named(name: str) -> type:
    """Return the class that a module of Slicer's sees under that name.

    Raises:
        AttributeError: Slicer has no such class, or the host does not offer it.
    """
    if module_of(name) is None:
        raise AttributeError(f"Neither Slicer nor the host is known to have {name}.")
    qt_class = _qt_class(name)
    # A stand-in may have the name of the class of Qt that it stands in for.
    ancestors = (kind.__name__ for kind in qt_class.__mro__ if kind.__name__ != name)
    base = next((class_named(kind) for kind in ancestors if _is_known(kind)), Proxy)
    return make_class(name, qt_class, base, members_of(name))


def class_for(qt_class: type) -> type:
    """Return the class that stands for a class of PySide6, or for its nearest known base."""
    for kind in qt_class.__mro__:
        if _is_known(kind.__name__):
            return class_named(kind.__name__)
    raise TypeError(f"The host does not know {qt_class.__name__}: add it to unmeasured.py.")


def _is_known(name: str) -> bool:
    return module_of(name) is not None


def _qt_class(name: str) -> type:
    for module in (stand_ins, QtWidgets, QtGui, QtCore, QtUiTools):
        if hasattr(module, name):
            return getattr(module, name)
    raise AttributeError(f"The host does not offer {name} yet.")


class ClassModule(ModuleType):
    """A module whose classes are made when they are asked for."""

    def __init__(self, name: str, source: str) -> None:
        super().__init__(name)
        self._source = source

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or module_of(name) != self._source:
            raise AttributeError(f"The module {self.__name__} has no {name}.")
        return class_named(name)


qt = ClassModule("qt", "qt")
qt.Qt = QtConstants()
ctk = ClassModule("ctk", "ctk")
