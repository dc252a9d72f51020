"""The modules `qt` and `ctk`: objects of PySide6 with PythonQt's manners.

A property is an attribute, a signal is connected by its signature, enumerations are ints, and what
real Slicer's class does not have raises AttributeError, on reading and on assigning.
"""

from __future__ import annotations

import enum
import functools
from collections.abc import Callable
from types import ModuleType
from typing import Any

import shiboken6
from PySide6 import QtCore, QtGui, QtUiTools, QtWidgets

from Testing.slicer.host import stand_ins
from Testing.slicer.host.activity import note_write
from Testing.slicer.host.members import Members, members_of, module_of
from Testing.slicer.host.values import (
    PROXY,
    BoundSignal,
    call,
    connect,
    construct,
    disconnect,
    from_qt,
    to_qt,
    wrap_objects_with,
)

# PythonQt spells Python's old keywords with an underscore.
ALIASES = {"exec_": "exec", "raise_": "raise"}
# Static functions that are hidden by a property of the same name on an object, not on the class.
STATIC_FUNCTIONS = {("QTimer", "singleShot")}

_class_of: dict[type, ProxyType] = {}


class ProxyType(type):
    """Gives constants and static functions on the class: `qt.Qt.AlignLeft`."""

    def __getattr__(cls, name: str) -> Any:
        if name.startswith("_") or name == "members":
            raise AttributeError(name)
        known = ALIASES.get(name, name) in cls.members.methods
        if not known and (cls._qtClass.__name__, name) not in STATIC_FUNCTIONS:
            raise _missing(cls, name)
        return _shown(cls._qtClass, name, _qt_attribute(cls._qtClass, name))


class Proxy(metaclass=ProxyType):
    """One object of Qt, as PythonQt shows it."""

    members: Members
    _qtClass: type

    def __init__(self, *arguments: Any) -> None:
        if "_qt" in self.__dict__:
            return
        if type(self) is not _class_of.get(self._qtClass):
            raise NotImplementedError("The host does not offer subclasses of Qt's classes yet.")
        _adopt(self, construct(self._qtClass, arguments))

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or "_qt" not in self.__dict__:
            raise AttributeError(name)
        members = self.members
        if name in members.properties:
            return from_qt(self._qt.property(name))
        if name == "name" and "objectName" in members.properties:
            return self._qt.objectName()
        if name in members.signatures:
            return BoundSignal(self, members.signatures[name][0])
        if ALIASES.get(name, name) not in members.methods:
            raise _missing(type(self), name)
        if name in ("connect", "disconnect"):
            function = connect if name == "connect" else disconnect
            return lambda *arguments: function(self, *arguments)
        if name == "className":
            return lambda: type(self._qt).__name__
        if name.startswith("set"):
            note_write(self._qt, name)
        return _shown(type(self._qt), name, _qt_attribute(self._qt, name))

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self.members.properties:
            note_write(self._qt, name)
            if value is None or not self._qt.setProperty(name, to_qt(value)):
                raise ValueError(f"The property {name} does not take {value!r}.")
        else:
            raise _missing(type(self), name)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Proxy) and self._qt == other._qt

    def __hash__(self) -> int:
        return hash(self._qt)

    def __bool__(self) -> bool:
        return shiboken6.isValid(self._qt)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self._qt!r}>"


class Method:
    """A function of Qt; PythonQt takes no keyword arguments."""

    def __init__(self, owner: type, name: str, function: Callable[..., Any]) -> None:
        self.__name__ = name
        self._owner = owner
        self._function = function

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        if keywords:
            raise TypeError(f"PythonQt takes no keyword arguments: {self.__name__}.")
        return call(self._owner, self._function, self.__name__, arguments)


def make_class(name: str, qt_class: type, base: type, members: Members) -> ProxyType:
    """Return the class that stands for a class of Qt."""
    made = ProxyType(name, (base,), {"members": members, "_qtClass": qt_class})
    _class_of[qt_class] = made
    return made


def wrap(value: Any) -> Any:
    """Return the proxy of an object, always the same one for an object that lives on."""
    proxy = getattr(value, PROXY, None)
    if proxy is not None:
        return proxy
    made = class_for(type(value))
    proxy = made.__new__(made)
    _adopt(proxy, value)
    return proxy


def _adopt(proxy: Proxy, value: Any) -> None:
    object.__setattr__(proxy, "_qt", value)
    setattr(value, PROXY, proxy)


def _qt_attribute(owner: Any, name: str) -> Any:
    for spelling in (ALIASES.get(name, name), name, name + "_"):
        found = getattr(owner, spelling, None)
        if found is not None:
            return found
    raise NotImplementedError(f"Slicer has {name}, but the host does not offer it yet.")


def _shown(owner: type, name: str, value: Any) -> Any:
    if isinstance(value, enum.Enum):
        return value.value
    return Method(owner, name, value) if callable(value) else value


def _missing(made: type, name: str) -> AttributeError:
    return AttributeError(f"Slicer's {made.__name__} has no {name}.")


class QtConstants:
    """Gives each constant of the namespace Qt as the int that PythonQt gives."""

    def __getattr__(self, name: str) -> Any:
        value = getattr(QtCore.Qt, name)
        return value.value if isinstance(value, enum.Enum) else value


@functools.cache
def class_named(name: str) -> type:
    """Return the class that a module of Slicer's sees under that name."""
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
    raise TypeError(f"The host does not know {qt_class.__name__}: add it to UNMEASURED.")


def _is_known(name: str) -> bool:
    return module_of(name) is not None


def _qt_class(name: str) -> type:
    for module in (stand_ins, QtWidgets, QtGui, QtCore, QtUiTools):
        if hasattr(module, name):
            return getattr(module, name)
    raise AttributeError(f"The host does not offer {name} yet.")


class ClassModule(ModuleType):
    """A module whose classes are made on request."""

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

wrap_objects_with(wrap)
