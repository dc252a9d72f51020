"""Tasks, tutorials and scores of each trainee, as the simulator's own files have them."""

from __future__ import annotations

import contextlib
import json
import math
import re
import uuid
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import make_folder, write_text
from rastrainer.journal.entries import Attempt, DrillEnd, JournalHeader, iso
from rastrainer.journal.folder import DRILL_SUFFIX, TUTORIAL_SUFFIX, journals_of
from rastrainer.journal.journal_file import (
    MAX_LINE_BYTES,
    NO_LINE,
    DamagedLineError,
    decode_line,
    file_stamp,
)
from rastrainer.json_checks import is_number
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import TRIAL_RUN, AbortReason, Phase, RegistrationMethod
from rastrainer.trial.record import AbortedTrial, TrialRecord
from rastrainer.trial.scoring import PASS_MARK, passes
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.record.trial_context import TutorialOutcome

_REGISTERED = b'"kind":"registered"'
_PRACTICED = (
    f'"phase":"{Phase.COMPLETE.value}"'.encode(),
    f'"reason":"{AbortReason.PRACTICE_OVER.value}"'.encode(),
)


_COUNTS_FOR = {
    kind.value: (kind.value, SourceKind.KEYBOARD.value)
    for kind in (SourceKind.GAMEPAD, SourceKind.MOUSE)
}
"""Keys also type an ID and go through menus: who has learned another device may come with them."""
MAX_SHOWN = 20
"""Number of trials in a trend."""
_MAX_TUTORIAL_BYTES = 1 << 20
_TAIL_BYTES = 1 << 17
_START = re.compile(
    rb'\{"n":(\d+),"previous":"([0-9a-f]{64})","kind":"(registered|scored|attempt|drill)"'
)


@dataclass(frozen=True)
class OwnTrial(TrialRow):
    """A scored or failed trial, as its trainee finds it again."""

    is_passed: bool | None = None
    journal: Path = Path()


class TraineeHistory:
    """Tells what each trainee has done, by the journals and the tutorials in a folder.

    A task counts as done when it was registered; its score says whether it was passed. The
    trial run also counts when all its points were touched, or when it was ended after its time was
    over, as the paper's procedure has it (figure 4).

    Attributes:
        done: tasks by trainee and scenario.
        skipped: trainees whose trial run does not wait for the tutorial, as (trainee, ""), and
            whose tasks do not wait for the trial run, each with the scenario.
        latest_trainees: who trained here before the simulator was started, the last first.
    """

    def __init__(self, records: Path) -> None:
        """Look at the first line and the end of each journal, and through the tutorials.

        Unusable files are ignored. Scores are read when first asked for.
        """
        self.skipped: set[tuple[str, str]] = set()
        self.learned: dict[str, TutorialOutcome] = {}
        self._records = records
        self._journals: dict[str, list[Path]] = defaultdict(list)
        self.done: dict[tuple[str, str], set[str]] = defaultdict(set)
        self._devices: dict[str, set[str]] = defaultdict(set)
        self._own: dict[Path, OwnTrial | None] = {}
        for path in sorted(records.glob("*.journal")):
            self._note_journal(path)
        self._drills: dict[Path, tuple[JournalHeader, DrillRecord | None]] = {}
        for path in sorted(records.glob(f"*{DRILL_SUFFIX}")):
            self._note_drill(path)
        for path in sorted(records.glob(f"*{TUTORIAL_SUFFIX}")):
            with contextlib.suppress(InputError, OSError):
                outcome = read_json(path, _MAX_TUTORIAL_BYTES)
                self.note_tutorial(record_from_json(TutorialOutcome, outcome))
        latest = {trainee: paths[-1].name for trainee, paths in self._journals.items()}
        self.latest_trainees = sorted(latest, key=lambda trainee: latest[trainee], reverse=True)

    def needs_no_trial_run(self, trainee: str, scenario: str) -> bool:
        head = trainee, scenario
        return head in self.skipped or bool(self.done[head])

    def missing_before(
        self, trainee: str, scenario: str, task: str, order: Sequence[str]
    ) -> str | None:
        """Return the first task that has to be done before another; None if all are done."""
        done = {*self.done[trainee, scenario]}
        done |= {TRIAL_RUN} if self.needs_no_trial_run(trainee, scenario) else set()
        return next((name for name in order[: order.index(task)] if name not in done), None)

    def has_learned(self, trainee: str, device: SourceKind) -> bool:
        return device.value in self._devices.get(trainee, ())

    def keep_tutorial(self, outcome: TutorialOutcome) -> None:
        self.note_tutorial(outcome)
        utc = iso(datetime.now(timezone.utc))
        path = self._records / f"{file_stamp(utc)}_{uuid.uuid4()}{TUTORIAL_SUFFIX}"
        make_folder(self._records, is_private=True)
        # One line, as a journal's first: by it the file is found when the trainee is deleted.
        line = json.dumps({"utc": utc, **record_to_json(outcome, with_defaults=True)})
        write_text(path, line + "\n", is_private=True)

    def note_tutorial(self, outcome: TutorialOutcome) -> None:
        self._devices[outcome.trainee].update(_COUNTS_FOR.get(outcome.device, (outcome.device,)))
        self.learned[outcome.trainee] = outcome

    def changed(self, trainee: str, trial_id: str) -> None:
        """Note that a trial of a trainee has begun, ended or been scored."""
        known = self._journals[trainee]
        for path in journals_of(self._records, trial_id) if trial_id else ():
            self._own.pop(path, None)
            if path not in known:
                known.append(path)

    def drill_changed(self, trial_id: str) -> None:
        """Note that a drill has begun or is finished."""
        for path in journals_of(self._records, trial_id, DRILL_SUFFIX):
            self._note_drill(path)

    def drills(self, trainee: str) -> tuple[DrillRecord, ...]:
        """Return the trainee's finished drills, oldest first."""
        records = [record for _, record in self._drills.values() if record is not None]
        return tuple(record for record in records if record.trainee == trainee)

    def left_drills(self, trainee: str) -> list[tuple[Path, JournalHeader]]:
        """Return the journals of a trainee's drills that are neither finished nor abandoned."""
        return [
            (path, header)
            for path, (header, record) in self._drills.items()
            if record is None and header.trainee == trainee and path.exists()
        ]

    def own(self, trainee: str) -> tuple[OwnTrial, ...]:
        """Return the trainee's scored trials except trial runs, and the failures, oldest first."""
        paths = self._journals.get(trainee, ())
        self._own |= {path: _own_trial(path) for path in paths if path not in self._own}
        found = (self._own[path] for path in paths)
        return tuple(trial for trial in found if trial is not None)

    def best(self, trainee: str, task: str) -> tuple[Path, ...]:
        """Return the journals of a trainee's acceptable trials of a task, the best score first."""
        found = [
            own
            for own in self.own(trainee)
            if own.task == task and own.acceptable and own.method == RegistrationMethod.FIDUCIALS
        ]
        found.sort(key=lambda own: -own.score)
        return tuple(own.journal for own in found)

    def trend(self, trainee: str, mode: str) -> tuple[float, ...]:
        """Return the newest scores of a trainee in a mode, by fiducials."""
        scores = [
            trial.score
            for trial in self.own(trainee)
            if (trial.mode, trial.method) == (mode, RegistrationMethod.FIDUCIALS)
            and not trial.is_aborted
        ]
        return tuple(scores[-MAX_SHOWN:])

    def _note_drill(self, path: Path) -> None:
        """Note what a drill's journal says; ignore it if it cannot be read."""
        with contextlib.suppress(OSError, DamagedLineError, InputError):
            with path.open("rb") as file:
                first = decode_line(file.readline(MAX_LINE_BYTES).rstrip(b"\n"), 1, NO_LINE)
            last, record = _last_entries(path), None
            if DrillEnd.kind in last:
                record = record_from_json(DrillRecord, last[DrillEnd.kind].get("record"))
            self._drills[path] = record_from_json(JournalHeader, first), record
            if Attempt.kind in last:
                del self._drills[path]

    def _note_journal(self, path: Path) -> None:
        try:
            with path.open("rb") as file:
                header = decode_line(file.readline(MAX_LINE_BYTES).rstrip(b"\n"), 1, NO_LINE)
                file.seek(max(0, path.stat().st_size - _TAIL_BYTES))
                tail = file.read(_TAIL_BYTES)
            what = header["trainee"], header["scenario"]["name"], header["task"]
        except (OSError, KeyError, TypeError, DamagedLineError):
            return
        if not all(isinstance(word, str) for word in what):
            return
        self._journals[what[0]].append(path)
        is_practiced = header["task"] == TRIAL_RUN and any(mark in tail for mark in _PRACTICED)
        if _REGISTERED in tail or is_practiced:
            trainee, scenario, task = what
            self.done[trainee, scenario].add(task)


def _last_entries(journal: Path) -> dict[str, dict[str, Any]]:
    """Return the entries at the end of a journal that have an outcome, by kind, as written."""
    with journal.open("rb") as file:
        file.seek(max(0, journal.stat().st_size - _TAIL_BYTES))
        lines = file.read(_TAIL_BYTES).split(b"\n")
    found = ((line, start) for line in lines if (start := _START.match(line)))
    entries = (decode_line(line, int(start[1]), start[2].decode()) for line, start in found)
    return {entry["kind"]: entry for entry in entries}


def _own_trial(journal: Path) -> OwnTrial | None:
    """Return the scored or failed trial of a journal; None for other and damaged journals."""
    try:
        last = _last_entries(journal)
        if "attempt" in last:
            aborted = record_from_json(AbortedTrial, last["attempt"]["record"])
            failed = OwnTrial.of(aborted, is_passed=False, journal=journal)
            return failed if aborted.counts_as_failed else None
        if "registered" not in last or "scored" not in last:
            return None
        record = record_from_json(TrialRecord, last["registered"]["record"])
        scored = last["scored"]["arguments"]
        details = scored["details"]
        if record.task == TRIAL_RUN:
            return None
        score = float(scored["score"])
        acceptable = details["isAccurate"] is True and not beyond_limits(details)
        verdict = is_passed(record.task, score, details)
        known = {"acceptable": acceptable, "is_passed": verdict, "journal": journal}
        return OwnTrial.of(record, values={"score": score}, **known)
    except (OSError, DamagedLineError, InputError, KeyError, TypeError, ValueError):
        return None


_LIMITS = (
    ("isAccurate", "result.not accurate"),
    ("isUnbiased", "result.not unbiased"),
    ("isSafe", "result.not safe"),
)


def detail_number(details: Mapping[str, Any], name: str) -> float | None:
    """Return a number of a score's details; None for anything else."""
    value = details.get(name)
    return float(value) if is_number(value) and math.isfinite(value) else None


def pass_mark(task: str, details: Mapping[str, Any]) -> float | None:
    """Return the score that passes; None in a trial run, and in a study without a mark."""
    if task == TRIAL_RUN:
        return None
    return detail_number({"passMark": PASS_MARK, **details}, "passMark")


def beyond_limits(details: Mapping[str, Any]) -> list[str]:
    """Return the keys of the sentences that say why a trial is not acceptable."""
    return [key for name, key in _LIMITS if details.get(name) is False]


def is_passed(task: str, score: float, details: Mapping[str, Any]) -> bool | None:
    """Return whether a trial is passed, with its procedure; None without a pass mark."""
    procedure = details.get("procedure")
    is_placed = not isinstance(procedure, dict) or procedure.get("acceptable") is not False
    is_acceptable = is_placed and not beyond_limits(details)
    mark = pass_mark(task, details)
    if mark is None:
        return None if is_acceptable else False
    return passes(score, is_acceptable, mark)
