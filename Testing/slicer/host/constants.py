"""`qt.Qt`: constants as ints."""

from __future__ import annotations

import enum
from typing import Any

from PySide6.QtCore import Qt


class QtConstants:
    """Gives each constant of the namespace Qt as the int that PythonQt gives."""

    def __getattr__(self, name: str) -> Any:
        value = getattr(Qt, name)
        return value.value if isinstance(value, enum.Enum) else value
