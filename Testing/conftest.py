"""What is promised of the whole takes longest: it is checked first, so that no worker waits."""

from __future__ import annotations

from pathlib import Path

HERE = Path(__file__).parent
LONGEST = ("end_to_end", "web", "security")
"""Folders whose tests start processes, browsers and attacks."""


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: item.path.relative_to(HERE).parts[0] not in LONGEST)
