"""Open an installed module in the host, in a process that finds our package there alone.

    PYTHONPATH=<tree>/Logic python -m Testing.slicer.installed_module <tree>/RASTrainer.py FOLDER

Prints one JSON object: where the package was found, and what the module shows.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import rastrainer
from Testing.slicer.host.host import Host


def main() -> None:
    """Open the module, find its scenario, and print the texts."""
    host = Host(Path(sys.argv[2]), Path(sys.argv[1]))
    session = host.open().logic.session
    package = session.simulator.setup.package
    seen = {
        "package": str(Path(rastrainer.__file__).parent),
        "checkout": package.checkout is not None,
        "setup": host.text("setupText"),
        "tasks": len(session.scenarios.find("colin27").tasks),
        "requirements": package.requirements().count("--hash=sha256:"),
    }
    host.close()
    print(json.dumps(seen | {"errors": host.errors}))


if __name__ == "__main__":
    main()
