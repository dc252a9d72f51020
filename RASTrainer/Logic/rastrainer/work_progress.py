"""Progress of long work, also between processes as lines of output."""

from __future__ import annotations

import io
import re
import sys
from collections.abc import Callable

Progress = Callable[[str, float], None]
"""Receives a step's name and the share of the work done, 0 to 1; may raise to cancel."""
Warn = Callable[[str], None]
"""Receives a warning, one sentence."""

HEAD_MADE = "The head is made."
_STEP = re.compile(r"\s*(\d+)%  (.+)")
_WARNING = "Warning: "


def no_progress(_step: str, _share: float) -> None:
    """Ignore the progress, if no one waits for the work."""


def allow_any_text() -> None:
    """Let what this program prints have ? for characters that the terminal cannot show."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def print_progress(step: str, share: float) -> None:
    """Print a step as a line for `report_line`."""
    print(f"{share:4.0%}  {step}", flush=True)


def print_warning(sentence: str) -> None:
    print(f"{_WARNING}{sentence}", flush=True)


def report_line(line: str, progress: Progress, warn: Warn) -> None:
    """Report the step or warning in a line of another process's output; ignore other lines."""
    step = _STEP.fullmatch(line)
    if step:
        progress(step.group(2), int(step.group(1)) / 100.0)
    elif line.startswith(_WARNING):
        warn(line.removeprefix(_WARNING))
