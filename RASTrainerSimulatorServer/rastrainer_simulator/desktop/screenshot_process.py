"""The short-lived process that draws a pickled `Screenshot`, which it reads from standard input."""

from __future__ import annotations

import contextlib
import os
import pickle
import sys

from rastrainer.errors import RASTrainerError
from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.screenshot import Screenshot, write_picture


def main() -> int:
    """Write the picture; return 2, with one sentence, where that is impossible."""
    with contextlib.suppress(AttributeError, OSError):
        os.nice(10)  # The control loop and the window come first.
    try:
        _save(pickle.load(sys.stdin.buffer))
    except RASTrainerError as error:
        print(error, file=sys.stderr)
        return 2
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
