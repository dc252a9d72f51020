"""Keep a moment of what the window shows as a picture in the best light.

Where the processor draws that takes seconds, in which the window must not stand still: a trainee
may be driving the arm. So a process of its own draws it.
"""

from __future__ import annotations

import asyncio
import pickle
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.private_files import make_private_folder
from rastrainer.private_folder import python_words
from rastrainer_simulator.desktop.inbox import Inbox, SceneNews
from rastrainer_simulator.desktop.quality import Quality
from rastrainer_simulator.flow.screen import Screen
from rastrainer_simulator.views.offscreen import write_png

MODULE = "rastrainer_simulator.desktop.still_process"
TOLD = 2
"""Exit status of a process that says in one sentence what is wrong."""


@dataclass(frozen=True)
class Still:
    """Everything that the picture is made of; the members of the inbox are as there.

    The pairing code is left out: a picture is shown to others.
    """

    path: Path
    size: tuple[int, int]
    quality: Quality
    scene: SceneNews | None
    state: Mapping[str, Any] | None
    screen: Screen | None
    problem: str
    holder: str

    @classmethod
    def of(cls, inbox: Inbox, path: Path, size: tuple[int, int], quality: Quality) -> Still:
        """Return what the inbox says now; `size` is in pixels."""
        news = (inbox.scene, inbox.state, inbox.screen, inbox.problem, inbox.holder)
        return cls(path, size, quality, *news)

    def inbox(self) -> Inbox:
        """Return an inbox that says the same again."""
        inbox = Inbox()
        inbox.scene, inbox.state = self.scene, self.state
        inbox.screen, inbox.problem, inbox.holder = self.screen, self.problem, self.holder
        return inbox


def picture_path(folder: Path) -> Path:
    """Return a path in a folder, named after the time."""
    name = datetime.now().strftime("rastrainer-%Y%m%d-%H%M%S-%f")
    return folder / f"{name[:-3]}.png"


def write_picture(pixels: np.ndarray, path: Path) -> None:
    """Write (height, width, 3) uint8 pixels as a PNG, in a folder that need not exist.

    Raises:
        InputError: it cannot be written.
    """
    try:
        make_private_folder(path.parent)
    except OSError as error:
        raise InputError(f"The folder {path.parent} cannot be made: {error.strerror}.") from None
    write_png(pixels, path)


async def keep_still(still: Still) -> None:
    """Draw and write the picture.

    Raises:
        InputError: it cannot be drawn or written.
    """
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*python_words(MODULE), stdin=pipe, stderr=pipe)
    _, said = await process.communicate(pickle.dumps(still))
    if process.returncode == TOLD:
        raise InputError(said.decode(errors="replace").strip().rpartition("\n")[2])
    if process.returncode != 0:
        raise InputError(f"The picture {still.path} cannot be drawn.")
