"""What mypy knows of Slicer, which exists only within Slicer: all but the module's bases is Any."""

from typing import Any

def __getattr__(name: str) -> Any: ...
