"""The mixin whose methods a widget inherits; the functions of this module are Any."""

from collections.abc import Callable
from typing import Any

class VTKObservationMixin:
    def addObserver(self, node: Any, event: Any, method: Callable[..., None]) -> None: ...
    def removeObservers(self, method: Callable[..., None] | None = None) -> None: ...

def __getattr__(name: str) -> Any: ...
