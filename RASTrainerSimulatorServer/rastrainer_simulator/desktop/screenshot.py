"""Save what the window shows as a picture of the best quality.

Software rendering takes seconds for that, and the window must not freeze: a trainee may be moving
the arm. So a separate process draws it.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import pickle
import sys
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError, RASTrainerError
from rastrainer.files.writing import make_folder
from rastrainer.python_environment import python_command
from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.head_marks import ShownTrace
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.viewports import Quality
from rastrainer_simulator.presentation.messages import StateNews
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.rendering.picture import write_png

MODULE = "rastrainer_simulator.desktop.screenshot"
INPUT_ERROR_STATUS = 2
"""Exit status of a process that says in one sentence what is wrong."""


@dataclass(frozen=True)
class Screenshot:
    """Everything that the picture is made of; the members of the inbox are as there.

    The pairing code is left out: a picture is shown to others.
    """

    path: Path
    size: tuple[int, int]
    quality: Quality
    scene: LoadedScene | None
    bodies: tuple[str, ...]
    state: StateNews | None
    screen: Screen | None
    trace: ShownTrace
    problem: str
    holder: str

    @classmethod
    def of(cls, inbox: Inbox, path: Path, size: tuple[int, int], quality: Quality) -> Screenshot:
        """Return the content of the inbox now; `size` is in pixels."""
        members = (inbox.scene, inbox.bodies, inbox.state, inbox.screen, inbox.trace)
        return cls(path, size, quality, *members, inbox.problem, inbox.holder)

    def inbox(self) -> Inbox:
        """Return an inbox with this content."""
        inbox = Inbox()
        inbox.scene, inbox.bodies, inbox.state = self.scene, self.bodies, self.state
        inbox.screen, inbox.trace = self.screen, self.trace
        inbox.problem, inbox.holder = self.problem, self.holder
        return inbox


def picture_path(folder: Path) -> Path:
    """Return a path in a folder, named after the time."""
    name = datetime.now().strftime("rastrainer-%Y%m%d-%H%M%S-%f")
    return folder / f"{name[:-3]}.png"


def write_picture(pixels: np.ndarray, path: Path) -> None:
    """Write (height, width, 3) uint8 pixels as a PNG, in a folder that need not exist."""
    make_folder(path.parent, is_private=True)
    write_png(pixels, path)


async def save_screenshot(screenshot: Screenshot) -> None:
    """Draw and write the picture."""
    pipe = asyncio.subprocess.PIPE
    process = await asyncio.create_subprocess_exec(*python_command(MODULE), stdin=pipe, stderr=pipe)
    _, errors = await process.communicate(pickle.dumps(screenshot))
    if process.returncode == INPUT_ERROR_STATUS:
        raise InputError(errors.decode(errors="replace").strip().rpartition("\n")[2])
    if process.returncode != 0:
        raise InputError(f"The picture {screenshot.path} cannot be drawn.")


def main() -> int:
    """Write the pickled `Screenshot` of standard input; return 2 where that is impossible."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(10)  # The control loop and the window come first.
    try:
        _save(pickle.load(sys.stdin.buffer))
    except RASTrainerError as error:
        print(error, file=sys.stderr)
        return INPUT_ERROR_STATUS
    return 0


def _save(screenshot: Screenshot) -> None:
    window = GlWindow(screenshot.size, is_fullscreen=False, is_hidden=True)
    try:
        picture = Picture(window, screenshot.inbox(), screenshot.quality)
        picture.is_due(0.0)
        picture.draw()
        write_picture(window.pixels(), screenshot.path)
    finally:
        window.close()


if __name__ == "__main__":
    sys.exit(main())
