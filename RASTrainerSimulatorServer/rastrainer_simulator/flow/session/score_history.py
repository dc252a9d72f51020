"""Each trainee's earlier scores and failures, by the simulator's own journals."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.journal_file import DamagedLineError, decode_line
from rastrainer.protocol import TRIAL_RUN
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer.trial.trainee_progress import PastTrial

MAX_SHOWN = 20
"""Scores of a trend: those of the newest trials."""
_TAIL_BYTES = 1 << 17
_START = re.compile(
    rb'\{"n":(\d+),"previous":"([0-9a-f]{64})","kind":"(registered|scored|attempt)"'
)


class ScoreHistory:
    """Reads a trainee's journals when first asked for them, and one that has grown again."""

    def __init__(self, records: Path, journals: Mapping[str, list[Path]]) -> None:
        """Prepare; `journals` are those of each trainee that are there already, oldest first."""
        self._records = records
        self._journals = {trainee: list(paths) for trainee, paths in journals.items()}
        self._past: dict[Path, PastTrial | None] = {}

    def changed(self, trainee: str, trial_id: str) -> None:
        """Take note that a trial of a trainee has begun, ended or been scored."""
        known = self._journals.setdefault(trainee, [])
        for path in journals_of(self._records, trial_id) if trial_id else ():
            self._past.pop(path, None)
            if path not in known:
                known.append(path)

    def of(self, trainee: str) -> tuple[PastTrial, ...]:
        """Return the trainee's scored trials but the trial runs, and the failures, oldest first."""
        paths = self._journals.get(trainee, ())
        self._past |= {path: _past_trial(path) for path in paths if path not in self._past}
        found = (self._past[path] for path in paths)
        return tuple(trial for trial in found if trial is not None)

    def best(self, trainee: str, task: str) -> tuple[Path, ...]:
        """Return the journals of a trainee's acceptable trials of a task, the best score first.

        Scores of other versions are left out.
        """
        self.of(trainee)
        found = []
        for path in self._journals.get(trainee, ()):
            trial = self._past[path]
            if trial is None or trial.task != task or not trial.acceptable:
                continue
            if trial.score_version == SCORE_VERSION:
                found.append((trial.score, path))
        return tuple(path for _score, path in sorted(found, key=lambda each: -each[0]))

    def trend(self, trainee: str, mode: str) -> tuple[float, ...]:
        """Return the newest scores of a trainee in a mode, all of the present version."""
        scores = [
            trial.score
            for trial in self.of(trainee)
            if trial.mode == mode and trial.score_version == SCORE_VERSION
        ]
        return tuple(scores[-MAX_SHOWN:])


def _past_trial(journal: Path) -> PastTrial | None:
    """Return the scored or failed trial of a journal; None for others and damaged ones."""
    try:
        last = {entry["kind"]: entry for entry in _last_entries(journal)}
        if "attempt" in last:
            aborted = AbortedTrial.from_json(last["attempt"]["record"])
            return PastTrial.failed(aborted) if aborted.counts_as_failed else None
        if "registered" not in last or "scored" not in last:
            return None
        record = TrialRecord.from_json(last["registered"]["record"])
        told = last["scored"]["arguments"]
        details = told["details"]
        if record.task == TRIAL_RUN or "scoreVersion" not in details:
            return None
        return PastTrial(
            record.trial_id,
            record.task,
            record.mode,
            record.completion_time_s,
            float(told["score"]),
            details["isAccurate"] is True
            and details.get("isUnbiased") is not False
            and details["isSafe"] is not False,
            score_version=str(details["scoreVersion"]),
        )
    except (OSError, DamagedLineError, InputError, KeyError, TypeError, ValueError):
        return None


def _last_entries(journal: Path) -> Iterator[dict[str, Any]]:
    """Yield the entries with a trial's outcome at the end of a journal, each as it was written."""
    with journal.open("rb") as file:
        file.seek(max(0, journal.stat().st_size - _TAIL_BYTES))
        for line in file.read(_TAIL_BYTES).split(b"\n"):
            found = _START.match(line)
            if found is not None:
                yield decode_line(line, int(found[1]), found[2].decode("ascii"))
