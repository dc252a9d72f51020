"""Values and slots between Python as modules of Slicer write it and PySide6.

PythonQt gives enumerations as ints and lists as tuples, and takes ints for enumerations; PySide6
does neither. PythonQt connects signals with Python functions by their signatures.
"""

from __future__ import annotations

import enum
import functools
import inspect
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
import shiboken6
from PySide6 import QtCore
from shibokensupport.signature import get_signature

from Testing.slicer.host.activity import run_slot
from Testing.slicer.host.failures import FAILURES

PROXY = "_proxyOfHost"
PLAIN = frozenset({str, int, float, bool, type(None)})
"""Types whose values are the same on both sides; most are of these."""
_wrappers: list[Callable[[Any], Any]] = []


def wrap_objects_with(wrap: Callable[[Any], Any]) -> None:
    """Have `from_qt` return `wrap(object)` for each object of Qt.

    The proxies call this: they are built on this module, which does not import them.
    """
    _wrappers.append(wrap)


def to_qt(value: Any) -> Any:
    """Return what PySide6 takes for a value of ours."""
    if type(value) in PLAIN:
        return value
    if isinstance(value, (np.integer, np.bool_)):
        raise TypeError(f"PythonQt takes no {type(value).__name__}: convert it to a Python number.")
    if isinstance(value, tuple) and type(value) is tuple:
        return tuple(to_qt(item) for item in value)
    if isinstance(value, list):
        return [to_qt(item) for item in value]
    return getattr(value, "_qt", value)


def from_qt(value: Any) -> Any:
    """Return what PythonQt would give for a value of PySide6."""
    if type(value) in PLAIN:
        return value
    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, (list, tuple)) and type(value) in (list, tuple):
        return tuple(from_qt(item) for item in value)
    return _wrappers[-1](value) if isinstance(value, shiboken6.Object) else value


def call(owner: type, function: Callable[..., Any], name: str, arguments: tuple) -> Any:
    """Call a function of a class of PySide6 with arguments as PythonQt takes them."""
    if not arguments:
        return from_qt(function())
    return from_qt(function(*_given(arguments, _enumerations(owner, name))))


def construct(qt_class: type, arguments: tuple) -> Any:
    """Return a new object."""
    return qt_class(*_given(arguments, _enumerations(qt_class, "")))


def _given(arguments: tuple, enumerations: list[list[type[enum.Enum] | None]]) -> list:
    given = [
        Slot(item) if callable(item) and not hasattr(item, "_qt") else to_qt(item)
        for item in arguments
    ]
    if not any(type(item) is int for item in given):
        return given
    for kinds in enumerations:
        pairs = list(zip(given, kinds, strict=False))
        isFitting = all(kind is None or isinstance(item, int) for item, kind in pairs)
        if len(kinds) >= len(given) and isFitting:
            return [item if kind is None else kind(item) for item, kind in pairs]
    return given


@functools.cache
def _enumerations(owner: type, name: str) -> list[list[type[enum.Enum] | None]]:
    """Return for each signature that has enumerations, which of its arguments are."""
    signatures = get_signature(getattr(owner, name, None) if name else owner) or []
    if not isinstance(signatures, list):
        signatures = [signatures]
    found = []
    for signature in signatures:
        parameters = [item for key, item in signature.parameters.items() if key != "self"]
        kinds = [
            item.annotation if _is_enumeration(item.annotation) else None for item in parameters
        ]
        if any(kinds):
            found.append(kinds)
    return found


def _is_enumeration(annotation: Any) -> bool:
    return inspect.isclass(annotation) and issubclass(annotation, enum.Enum)


CONNECTIONS = "_connectionsOfHost"


class Slot:
    """Calls a function with as many arguments as it takes, and catches its errors."""

    watchers: ClassVar[list[Callable[[], None]]] = []
    _depth: ClassVar[int] = 0

    def __init__(self, function: Callable[..., Any], argument_count: int | None = None) -> None:
        self.function = function
        taken = _positional_count(function)
        self._count = taken if argument_count is None else min(taken, argument_count)
        self.is_tick = False

    def __call__(self, *arguments: Any) -> None:
        given = [from_qt(item) for item in arguments[: self._count]]
        Slot._tell_watchers()
        Slot._depth += 1
        try:
            run_slot(self.function, given, self.is_tick)
        except Exception as exception:  # PythonQt prints it, and continues.
            FAILURES.catch(exception)
        finally:
            Slot._depth -= 1
            Slot._tell_watchers()

    @classmethod
    def _tell_watchers(cls) -> None:
        if not cls._depth:
            for watcher in cls.watchers:
                watcher()


class BoundSignal:
    """A signal as an attribute of its object, to emit it: `combo.activated`."""

    def __init__(self, proxy: Any, signature: str) -> None:
        self._proxy = proxy
        self._signature = signature

    def emit(self, *arguments: Any) -> None:
        name = self._signature.partition("(")[0]
        getattr(self._proxy._qt, name).emit(*map(to_qt, arguments))


def connect(proxy: Any, signature: str, function: Callable[..., Any]) -> bool:
    """Connect, or return False if Slicer's class has no such signal, as PythonQt does."""
    signature = signature.replace(" ", "")
    if signature not in proxy.members.signals:
        return False
    if not callable(function):
        raise TypeError("A slot must be callable.")
    arguments = signature.partition("(")[2].rstrip(")")
    source = proxy._qt
    slot = Slot(function, len(arguments.split(",")) if arguments else 0)
    slot.is_tick = isinstance(source, QtCore.QTimer)
    if source.metaObject().indexOfSignal(signature) >= 0:
        QtCore.QObject.connect(source, QtCore.SIGNAL(signature), slot)
        undo = (QtCore.SIGNAL(signature), slot)
    else:
        signal = getattr(source, signature.partition("(")[0], None)
        if signal is None or not _is_of_host(source, signature):
            raise NotImplementedError(f"The host does not offer the signal {signature} of Qt 5.")
        signal.connect(slot)
        undo = (signal, slot)
    if CONNECTIONS not in source.__dict__:
        source.__dict__[CONNECTIONS] = []
        source.destroyed.connect(_releasing(source.__dict__[CONNECTIONS]))
    source.__dict__[CONNECTIONS].append((signature, function, undo))
    return True


def _releasing(connections: list[tuple]) -> Callable[[], None]:
    """Return what releases the functions, as PythonQt does when their object is deleted.

    PySide6 would keep the slots of a deleted object.
    """

    def release() -> None:
        for _signature, _function, (_signal, slot) in connections:
            slot.function = _nothing
        connections.clear()

    return release


def _nothing(*_arguments: Any) -> None:
    """Replaces a function that was released."""


def disconnect(proxy: Any, signature: str, function: Callable[..., Any] | None = None) -> bool:
    """Undo `connect`; return whether there was such a connection."""
    signature = signature.replace(" ", "")
    source = proxy._qt
    connections = source.__dict__.get(CONNECTIONS, [])
    found = [item for item in connections if item[0] == signature and function in (None, item[1])]
    for item in found:
        signal, slot = item[2]
        if isinstance(signal, (str, bytes)):
            QtCore.QObject.disconnect(source, signal, slot)
        else:
            signal.disconnect(slot)
        connections.remove(item)
    return bool(found)


def _is_of_host(source: QtCore.QObject, signature: str) -> bool:
    """Return whether a Python class of ours declares the signal: its types are Python's then."""
    name = signature.partition("(")[0]
    return any(
        name in vars(kind)
        for kind in type(source).__mro__
        if not kind.__module__.startswith("PySide6")
    )


def _positional_count(function: Callable[..., Any]) -> int:
    try:
        parameters = inspect.signature(function).parameters.values()
    except ValueError:  # A function of C++ does not say.
        return 9
    if any(item.kind is item.VAR_POSITIONAL for item in parameters):
        return 9
    kinds = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(item.kind in kinds for item in parameters)
