"""Whether records and settings can be written and read."""

from __future__ import annotations

import contextlib
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer_simulator.cli.doctor.check_result import CheckResult, CheckStatus
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.flow.session.preferences import PREFERENCES_FILE, read_preferences
from rastrainer_simulator.input.bindings import BINDINGS_FILE, read_bindings
from rastrainer_simulator.net.limits import read_limits
from rastrainer_simulator.record.trial_archive import TrialArchive

MEGABYTE = 1_000_000
TRIAL_MB = 6.0
"""A journal of a long trial."""
PROBLEM_MB = 100.0
WARNING_MB = 1000.0


def check_folders(folders: Mapping[str, Path]) -> Iterator[CheckResult]:
    """Check writing to each folder, by purpose; a missing one is checked by its parent."""
    for purpose, folder in folders.items():
        yield _check(purpose, folder)


def _check(purpose: str, folder: Path) -> CheckResult:
    existing = _existing(folder)
    try:
        if existing != folder and not existing.is_dir():
            raise NotADirectoryError(20, f"{existing} is a file")
        with tempfile.TemporaryFile(dir=existing):
            pass
        free_mb = shutil.disk_usage(existing).free / MEGABYTE
    except OSError as error:
        return CheckResult(
            "folders",
            CheckStatus.PROBLEM,
            f"The folder of the {purpose}, {folder}, cannot be written to: {error.strerror}.",
            f"Allow writing to {existing}, or choose another folder: rastrainer simulator --help",
        )
    room = f"The folder of the {purpose}, {folder}, can be written to; {free_mb:,.0f} MB are free"
    if free_mb < PROBLEM_MB:
        return CheckResult("folders", CheckStatus.PROBLEM, f"{room}: too few.", "Free some space.")
    if free_mb < WARNING_MB:
        trials = int(free_mb / TRIAL_MB)
        sentence = f"{room}, enough for about {trials} trials."
        return CheckResult("folders", CheckStatus.WARNING, sentence, "Free some space.")
    return CheckResult("folders", CheckStatus.OK, f"{room}.")


def _existing(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that exists."""
    with contextlib.suppress(OSError):
        for candidate in (folder, *folder.absolute().parents):
            if candidate.exists():
                return candidate
    return folder


def check_settings(config: Path) -> Iterator[CheckResult]:
    """Read each existing file of the settings."""
    try:
        read_limits(config)
    except InputError as error:
        remedy = "Fix the file, or delete it to use the default limits."
        yield CheckResult("settings", CheckStatus.PROBLEM, f"No simulator starts: {error}", remedy)
    readers = {PREFERENCES_FILE: read_preferences, BINDINGS_FILE: read_bindings}
    for name, read in readers.items():
        try:
            if (config / name).exists():
                read(config / name)
        except InputError as error:
            remedy = "Choose them again in the trainee's menu, which rewrites the file."
            yield CheckResult(
                "settings", CheckStatus.WARNING, f"The defaults are used: {error}", remedy
            )


KEEP_IT = "Keep the file unchanged; `rastrainer verify` and its path show how far it can be read."


def check_journals(records: Path) -> Iterator[CheckResult]:
    """Read the journals that a simulator reads when it starts: those to deliver, and the newest."""
    archive = TrialArchive(records)
    problems = dict.fromkeys(archive.problems)
    try:
        find_interrupted(records)
    except InputError as error:
        problems[str(error)] = None
    for problem in problems:
        yield CheckResult("journals", CheckStatus.WARNING, problem, KEEP_IT)
    if not problems:
        waiting = len(archive.unacknowledged())
        sentence = f"Every journal that is needed can be read; {waiting} trials wait for Slicer."
        yield CheckResult("journals", CheckStatus.OK, sentence)
