"""The short-lived process that builds a scene: VTK would stop the control loop's process.

It reads one JSON object from standard input: `scenario` and `robotMeshes` (folders, null for the
meshes that come with RASTrainer), `task` (a name, or "" for none) and `path` (the file to write).
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
import uuid
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.scene.scene_glb import scene_glb


def main() -> int:
    """Build the given scene; if that is impossible, print one sentence and return 2."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(10)  # The control loop of the parent comes first.
    wanted = json.load(sys.stdin)
    meshes, task = wanted["robotMeshes"], wanted["task"]
    try:
        setup = load_setup(Path(wanted["scenario"]), robot_meshes=meshes and Path(meshes))
        chosen = setup.scenario.task(task) if task else None
        _write(Path(wanted["path"]), scene_glb(setup.scenario, setup.robot, chosen))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _write(path: Path, content: bytes) -> None:
    """Write a file whole or not at all: others may build the same one at the same time."""
    partial = path.with_name(f"{uuid.uuid4().hex}.partial")
    try:
        partial.write_bytes(content)
        partial.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            partial.unlink()
        raise InputError(f"The scene {path} cannot be written: {error.strerror}.") from error


if __name__ == "__main__":
    sys.exit(main())
