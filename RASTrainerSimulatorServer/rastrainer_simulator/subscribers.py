"""Who is told what happens."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

T = TypeVar("T")


class Subscribers(Generic[T]):
    """Callbacks that are given everything that is told, in the thread that tells it.

    They may come and go while they are being told, from other threads, too.
    """

    def __init__(self) -> None:
        self._callbacks: tuple[Callable[[T], None], ...] = ()

    def add(self, callback: Callable[[T], None]) -> Callable[[], None]:
        """Have `callback` called with what is told from now on; returns what ends that."""
        self._callbacks = (*self._callbacks, callback)

        def remove() -> None:
            self._callbacks = tuple(one for one in self._callbacks if one is not callback)

        return remove

    def tell(self, news: T) -> None:
        """Call everyone."""
        for callback in self._callbacks:
            callback(news)
