"""Whether what is still to be done with recorded trials can be done."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer_simulator.doctor.finding import Finding, Verdict
from rastrainer_simulator.record.interrupted_trial import find_interrupted
from rastrainer_simulator.record.trial_archive import TrialArchive

KEEP_IT = "Keep the file as it is; `rastrainer verify` and its path tell how far it can be read."


def check_journals(records: Path) -> Iterator[Finding]:
    """Read the journals that a simulator reads when it starts: those to deliver, and the newest."""
    archive = TrialArchive(records)
    problems = dict.fromkeys(archive.problems)
    try:
        find_interrupted(records)
    except InputError as error:
        problems[str(error)] = None
    for problem in problems:
        yield Finding("journals", Verdict.WARNING, problem, KEEP_IT)
    if not problems:
        waiting = len(archive.unacknowledged())
        told = f"Every journal that is needed can be read; {waiting} trials wait for Slicer."
        yield Finding("journals", Verdict.OK, told)
