"""The short-lived process that opens a hidden window: a broken OpenGL may take its process down."""

from __future__ import annotations

import sys

from rastrainer.errors import RASTrainerError


def main() -> int:
    """Print the name of OpenGL's renderer; return 2, with one sentence, where there is none."""
    from rastrainer_simulator.desktop.gl_window import GlWindow

    try:
        window = GlWindow((320, 240), is_fullscreen=False, is_hidden=True)
    except RASTrainerError as error:
        print(error, file=sys.stderr)
        return 2
    print(f"renderer: {window.renderer_name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
