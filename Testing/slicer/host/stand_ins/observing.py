"""Observers that end with the widget that wants them: VTK would keep a dead widget's alive."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any

import shiboken6
import vtk


def weakly(method: Callable[..., None]) -> Callable[..., None]:
    """Return an observer that calls a widget's method `(event, object or None)` while it lives."""
    reference = weakref.WeakMethod(method)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def observe(_caller: Any, event: str, call_data: Any = None) -> None:
        alive = reference()
        if alive is not None and shiboken6.isValid(alive.__self__):
            alive(event, call_data)

    return observe


def unobserving(observed: Any, tags: list[int]) -> Callable[[], None]:
    """Return a function that ends the observers of a widget that is deleted."""

    def unobserve() -> None:
        for tag in tags:
            observed.RemoveObserver(tag)

    return unobserve
