"""Values on their way between Python as Slicer's modules write it and PySide6.

PythonQt gives enumerations as ints and lists as tuples, and takes ints for enumerations; PySide6
does neither.
"""

from __future__ import annotations

import enum
import functools
import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import shiboken6
from shibokensupport.signature import get_signature

PROXY = "_proxyOfHost"


def to_qt(value: Any) -> Any:
    """Return what PySide6 takes for a value of ours."""
    if isinstance(value, (np.integer, np.bool_)):
        raise TypeError(f"PythonQt takes no {type(value).__name__}: convert it to a Python number.")
    if isinstance(value, tuple) and type(value) is tuple:
        return tuple(to_qt(item) for item in value)
    if isinstance(value, list):
        return [to_qt(item) for item in value]
    return getattr(value, "_qt", value)


def from_qt(value: Any) -> Any:
    """Return what PythonQt would give for a value of PySide6."""
    from Testing.slicer.host.proxy import wrap

    if isinstance(value, enum.Enum):
        return value.value
    if isinstance(value, (list, tuple)) and type(value) in (list, tuple):
        return tuple(from_qt(item) for item in value)
    return wrap(value) if isinstance(value, shiboken6.Object) else value


def call(owner: type, function: Callable[..., Any], name: str, arguments: tuple) -> Any:
    """Call a function of a class of PySide6 with arguments as PythonQt takes them."""
    return from_qt(function(*_given(arguments, _enumerations(owner, name))))


def construct(qt_class: type, made: type, arguments: tuple) -> Any:
    """Return a new object of `made`, a subclass of `qt_class`."""
    return made(*_given(arguments, _enumerations(qt_class, "")))


def _given(arguments: tuple, enumerations: list[list[type[enum.Enum] | None]]) -> list:
    from Testing.slicer.host.slots import Slot

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
