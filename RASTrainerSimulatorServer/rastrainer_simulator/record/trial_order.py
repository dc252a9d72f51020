"""In which order the trials of a folder were begun, which their names tell only by the clock."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path

from rastrainer.journal.folder import SUFFIX

_REACH = 512
_NUMBER = re.compile(rb'"kind":"header","format":"[a-z-]+","version":\d+,"number":(\d+),')


def newest_journal(folder: Path) -> Path | None:
    """Return the journal of the trial that was begun last; None where there is no journal.

    A clock that was set back gives a later trial an earlier name. So the trials of a folder are
    numbered; those that a version before the numbers has written are older, and in the order of
    their names.
    """
    paths = folder.glob(f"*{SUFFIX}")
    return max(paths, key=lambda path: (number_of(path), path.name), default=None)


def number_of(path: Path) -> int:
    """Return the number in a journal's header; 0 where there is none."""
    with contextlib.suppress(OSError), path.open("rb") as file:
        found = _NUMBER.search(file.read(_REACH))
        return int(found[1]) if found else 0
    return 0
