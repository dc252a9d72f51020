"""Callbacks for whatever is published."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Subscribers(Generic[T]):
    """Callbacks that are given everything that is published, in the publishing thread.

    They may be added and removed meanwhile, also from other threads.
    """

    def __init__(self) -> None:
        self._callbacks: tuple[Callable[[T], None], ...] = ()

    def add(self, callback: Callable[[T], None]) -> Callable[[], None]:
        """Call `callback` with what is published from now on; returns what ends that."""
        self._callbacks = (*self._callbacks, callback)

        def remove() -> None:
            self._callbacks = tuple(one for one in self._callbacks if one is not callback)

        return remove

    def publish(self, item: T) -> None:
        """Call every callback."""
        for callback in self._callbacks:
            callback(item)
