"""What a scene's file depends on, as one hash: the same key, the same picture."""

from __future__ import annotations

import hashlib
from pathlib import Path

import rastrainer
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.setup import SimulationSetup


def setup_digest(setup: SimulationSetup) -> bytes:
    """Return a hash of scenario, robot and the code that makes scenes of them; reads their files.

    A file that cannot be read counts as empty: who builds the scene says what is wrong.
    """
    whole = hashlib.sha256(f"{rastrainer.__version__} {setup.scenario_sha256}".encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        whole.update(_digest(path))
    whole.update(_robot(setup.robot).encode())
    for part in setup.robot.meshes:
        if part.kind == "visual":
            whole.update(_digest(part.path))
    return whole.digest()


def scene_key(digest: bytes, task: str) -> str:
    """Return the key of one task's scene; "" is that without a task."""
    return hashlib.sha256(digest + task.encode()).hexdigest()[:32]


def _robot(robot: RobotModel) -> str:
    links = [(link.name, link.joint, link.offset.tolist()) for link in robot.links]
    parts = [
        (part.link, part.origin.tolist(), part.scale, part.color, part.replaced)
        for part in robot.meshes
        if part.kind == "visual"
    ]
    return repr((robot.tip.name, links, parts))


def _digest(path: Path) -> bytes:
    try:
        return hashlib.sha256(path.read_bytes()).digest()
    except OSError:
        return b""
