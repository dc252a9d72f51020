"""The scenes as files: built once by a separate process, then cached."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import gzip
import hashlib
import struct
import subprocess
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import rastrainer
from rastrainer.errors import InputError
from rastrainer.python_environment import python_command
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.ops.processes import BELOW_NORMAL
from rastrainer_simulator.ops.system_paths import cache_folder


def setup_digest(setup: SimulationSetup) -> bytes:
    """Return a hash of scenario, robot and the code that makes scenes of them; reads their files.

    A file that cannot be read counts as empty: building the scene reports the error.
    """
    robot = setup.robot
    links = [(link.name, link.joint, link.offset.tolist()) for link in robot.links]
    parts = [(part.link, part.origin.tolist(), part.color, part.replaced) for part in robot.meshes]
    values = rastrainer.__version__, setup.scenario_sha256, robot.tip.name, links, parts
    whole = hashlib.sha256(repr(values).encode())
    code = sorted(Path(__file__).parent.glob("*.[pj]*"))
    for path in (*code, *(part.path for part in robot.meshes)):
        whole.update(hashlib.sha256(_content(path)).digest())
    return whole.digest()


def scene_key(digest: bytes, task: str) -> str:
    return hashlib.sha256(digest + task.encode()).hexdigest()[:32]


def _content(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        return b""


KEPT_FILES = 60


def scenes_folder() -> Path:
    """Return the user's cache folder for scenes, made if needed; a temporary one if impossible."""
    try:
        folder = cache_folder() / "scenes"
        folder.mkdir(parents=True, exist_ok=True)
        (folder / ".writable").touch()
    except (OSError, InputError):
        return Path(tempfile.mkdtemp(prefix="rastrainer-scenes-"))
    return folder


def forget_oldest(folder: Path) -> None:
    """Delete all but the newest scenes, and partial files left by a crash."""
    with contextlib.suppress(OSError):
        files = [path for path in folder.iterdir() if path.suffix in (".glb", ".partial")]
        files.sort(key=lambda path: path.stat().st_mtime, reverse=True)
        for path in files[KEPT_FILES:]:
            path.unlink(missing_ok=True)


NO_TASK = ""
GZIP_LEVEL = 6
"""Higher levels take longer and save less than one percent."""
_HEADER = struct.Struct("<4sII")


@dataclass(frozen=True)
class SceneFile:
    """A scene that is ready: its GLB file, and the hash of its content in hexadecimal digits."""

    sha256: str
    path: Path


class SceneFiles:
    """Provides the scenes of a setup; missing scenes are built, the wanted scene first."""

    def __init__(self, folder: Path, robot_meshes: Path | None = None) -> None:
        """Keep scenes in `folder`; `robot_meshes` are those that the setups were loaded with."""
        self._folder = folder
        self._robot_meshes = robot_meshes
        self._ready: dict[Path, SceneFile] = {}
        self.by_hash: dict[str, SceneFile] = {}
        """The scenes that have been given before."""
        self._paths: tuple[SimulationSetup, Mapping[str, Path]] | None = None
        self._one_at_a_time = asyncio.Lock()

    async def scene(self, setup: SimulationSetup, task: str) -> SceneFile:
        """Return the scene of a task, or without a task; building it takes seconds.

        Canceling the wait ends the building, too.
        """
        if task != NO_TASK:
            setup.scenario.task(task)
        path = (await self._paths_of(setup))[task]
        if path not in self._ready:
            async with self._one_at_a_time:
                if path not in self._ready and not await self._use_built(path):
                    await self._build(setup, task, path)
                    await asyncio.to_thread(forget_oldest, self._folder)
                    if not await self._use_built(path):
                        raise InputError(f"The scene {path} has been deleted or changed by others.")
        return self._ready[path]

    async def build_all(self, setup: SimulationSetup) -> None:
        """Build the missing scenes of a setup, so that no task has to wait for its scene."""
        for task in await self._paths_of(setup):
            await self.scene(setup, task)

    async def _paths_of(self, setup: SimulationSetup) -> Mapping[str, Path]:
        if self._paths is None or self._paths[0] is not setup:
            digest = await asyncio.to_thread(setup_digest, setup)
            tasks = (NO_TASK, *(task.name for task in setup.scenario.tasks))
            paths = {task: self._folder / f"{scene_key(digest, task)}.glb" for task in tasks}
            self._paths = (setup, paths)
        return self._paths[1]

    async def _use_built(self, path: Path) -> bool:
        content = await asyncio.to_thread(_content, path)
        if not content.startswith(_HEADER.pack(b"glTF", 2, len(content))):
            return False  # It is missing, or was not written to its end.
        sha256 = await asyncio.to_thread(lambda: hashlib.sha256(content).hexdigest())
        file = SceneFile(sha256, path)
        self._ready[path] = self.by_hash[sha256] = file
        return True

    async def _build(self, setup: SimulationSetup, task: str, path: Path) -> None:
        meshes = self._robot_meshes
        wanted = setup.scenario.folder, "" if meshes is None else meshes, task, path
        try:
            process = await asyncio.create_subprocess_exec(
                *python_command("rastrainer_simulator.scene.scene_glb", *map(str, wanted)),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                creationflags=BELOW_NORMAL,
            )
        except OSError as error:
            raise InputError(f"The scene cannot be built: {error}.") from error
        try:
            _, errors = await process.communicate()
        finally:
            # The waiting task may have been canceled.
            if process.returncode is None:
                process.kill()
                await process.wait()
        if process.returncode:
            sentence = errors.decode(errors="replace").strip() or f"status {process.returncode}"
            raise InputError(f"The scene could not be built: {sentence}")


@functools.lru_cache(maxsize=2)
def gzipped_scene(file: SceneFile) -> tuple[bytes, int]:
    """Return the content compressed, half as large, and how large it was; takes 0.2 s at first.

    Raises LookupError if the file has changed.
    """
    content = _content(file.path)
    if hashlib.sha256(content).hexdigest() != file.sha256:
        raise LookupError(file.path)
    return gzip.compress(content, GZIP_LEVEL, mtime=0), len(content)
