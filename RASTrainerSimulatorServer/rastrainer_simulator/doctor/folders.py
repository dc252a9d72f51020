"""Whether what is recorded and chosen can be written, and for how long."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from rastrainer_simulator.doctor.finding import Finding, Verdict

MEGABYTE = 1_000_000
TRIAL_MB = 6.0
"""A journal of a long trial."""
PROBLEM_MB = 100.0
WARNING_MB = 1000.0


def check_folders(folders: Mapping[str, Path]) -> Iterator[Finding]:
    """Write to each folder, by what it is for; what is missing is judged by what it will lie in."""
    for purpose, folder in folders.items():
        yield _check(purpose, folder)


def _check(purpose: str, folder: Path) -> Finding:
    existing = _existing(folder)
    try:
        if existing != folder and not existing.is_dir():
            raise NotADirectoryError(20, f"{existing} is a file")
        with tempfile.TemporaryFile(dir=existing):
            pass
        free_mb = shutil.disk_usage(existing).free / MEGABYTE
    except OSError as error:
        return Finding(
            "folders",
            Verdict.PROBLEM,
            f"The folder of the {purpose}, {folder}, cannot be written to: {error.strerror}.",
            f"Allow writing to {existing}, or choose another folder: rastrainer simulator --help",
        )
    told = f"The folder of the {purpose}, {folder}, can be written to; {free_mb:,.0f} MB are free"
    if free_mb < PROBLEM_MB:
        return Finding("folders", Verdict.PROBLEM, f"{told}: too little.", "Make room.")
    if free_mb < WARNING_MB:
        trials = int(free_mb / TRIAL_MB)
        sentence = f"{told}, enough for about {trials} trials."
        return Finding("folders", Verdict.WARNING, sentence, "Make room.")
    return Finding("folders", Verdict.OK, f"{told}.")


def _existing(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that exists."""
    with contextlib.suppress(OSError):
        for candidate in (folder, *folder.absolute().parents):
            if candidate.exists():
                return candidate
    return folder
