"""Display and OpenGL: whether the trainee's window can open, and whether a graphics card draws."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence

from rastrainer.private_folder import python_words
from rastrainer_simulator.doctor.finding import Finding, Verdict

PROBE = "rastrainer_simulator.doctor.gl_probe"
LONGEST_PROBE_S = 60.0
IN_SOFTWARE = ("llvmpipe", "softpipe", "swiftshader", "gdi generic", "microsoft basic render")
NO_WINDOW = "The trainee's window cannot open; browsers and headsets can still be used."

_ANSWER = "renderer: "


def check_graphics(probe: Sequence[str] = ()) -> Iterator[Finding]:
    """Open a hidden window and tell who draws it; `probe` is the command that does, if not ours."""
    has_x11_or_wayland = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not has_x11_or_wayland:
        yield Finding(
            "graphics",
            Verdict.WARNING,
            f"There is no display. {NO_WINDOW}",
            "Start from a desktop session, or set DISPLAY.",
        )
        return
    try:
        done = subprocess.run(
            probe or python_words(PROBE),
            capture_output=True,
            text=True,
            timeout=LONGEST_PROBE_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        yield _failure(f"A window did not open within {LONGEST_PROBE_S:g} s.")
        return
    answers = [line for line in done.stdout.splitlines() if line.startswith(_ANSWER)]
    if done.returncode != 0 or not answers:
        said = (done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"])[-1]
        yield _failure(f"OpenGL does not work: {said}")
        return
    renderer = answers[0].removeprefix(_ANSWER)
    if any(name in renderer.lower() for name in IN_SOFTWARE):
        yield Finding(
            "graphics",
            Verdict.WARNING,
            f"OpenGL works, but the processor draws: {renderer}.",
            "Install the graphics card's driver: pictures come slowly without.",
        )
    else:
        yield Finding("graphics", Verdict.OK, f"OpenGL works: {renderer}.")


def _failure(sentence: str) -> Finding:
    remedy = "Install the graphics card's driver, OpenGL 3.2 or newer."
    return Finding("graphics", Verdict.WARNING, f"{sentence} {NO_WINDOW}", remedy)
