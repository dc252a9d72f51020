"""Have Slicer's side make the draft of a head: in a process of its own, as it knows MRML."""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario_draft import HeadDraft, read_draft

_PROGRESS = re.compile(r"\s*(\d+)%  (.+)")
_WARNING = "Warning: "


def head_of(
    volume: Path,
    options: list[str],
    progress: Callable[[str, float], None],
    warn: Callable[[str], None],
) -> HeadDraft:
    """Return the head in a volume's file or in a folder of DICOM files.

    Args:
        volume: NRRD, NIfTI, or a folder.
        options: further arguments of `python -m rastrainer.slicer.head`.
        progress: told each step's name and the share of the work done; may raise to cancel.
        warn: told each warning.

    Raises:
        InputError: there is no head in it; the sentence says why.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "draft"
        words = ["-m", "rastrainer.slicer.head", str(volume), "-o", str(folder), *options]
        with (
            tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as errors,
            subprocess.Popen(
                [sys.executable, *words], stdout=subprocess.PIPE, stderr=errors, text=True
            ) as process,
        ):
            try:
                for line in process.stdout:
                    _tell(line.rstrip(), progress, warn)
            except BaseException:
                process.kill()
                raise
            status = process.wait()
            errors.seek(0)
            told = errors.read().strip().splitlines()
        if status != 0:
            raise InputError(told[-1] if told else f"The head's process ended with {status}.")
        return read_draft(folder)


def _tell(line: str, progress: Callable[[str, float], None], warn: Callable[[str], None]) -> None:
    step = _PROGRESS.fullmatch(line)
    if step:
        progress(step.group(2), int(step.group(1)) / 100.0)
    elif line.startswith(_WARNING):
        warn(line.removeprefix(_WARNING))
