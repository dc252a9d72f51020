"""Journals of scored and aborted trials, and the task menu of their trainee."""

from __future__ import annotations

import uuid
from pathlib import Path

from rastrainer.journal.journal_file import NO_LINE, encode_line
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.trial.record import AbortedTrial, TrialRecord
from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.presentation.screen import Screen
from Testing.domain.trial.trial_records import make_aborted, make_record

TRAINEE = "P07"
SCORES = (38.0, 52.4, 47.0, 66.6, 71.0, 69.0, 88.0)


def write_scored(folder, number, *scores, is_safe=True, make=make_record, **changes) -> Path:
    """Write the journal of a trial that was scored as often as there are scores."""
    trial_id = str(uuid.UUID(int=number))
    record = record_from_json(TrialRecord, make(trialId=trial_id, trainee=TRAINEE, **changes))
    details = {"isAccurate": True, "isUnbiased": True, "isSafe": is_safe}
    found = [{"trialId": trial_id, "score": score, "details": details} for score in scores]
    registered = {"kind": "registered", "record": record_to_json(record)}
    scored = ({"kind": "scored", "arguments": arguments} for arguments in found)
    return _write(folder, number, record, registered, *scored)


def write_aborted(folder, number, **changes) -> Path:
    """Write the journal of a trial that was aborted."""
    record = record_from_json(AbortedTrial, make_aborted(number, trainee=TRAINEE, **changes))
    return _write(folder, number, record, {"kind": "attempt", "record": record_to_json(record)})


def _write(folder, number, record, *entries) -> Path:
    name = f"20240517T{number:06d}Z_{record.trial_id}"
    who = record.trainee, record.task
    return write_journal(folder, name, *who, *entries, scenario=record.scenario)


def write_journal(folder, name, trainee, task, *entries, scenario="colin27") -> Path:
    """Write a journal with these entries, or kinds of entries, after its header."""
    header = {"kind": "header", "trainee": trainee, "scenario": {"name": scenario}, "task": task}
    lines, previous = [], NO_LINE
    for number, entry in enumerate((header, *entries), 1):
        entry = {"kind": entry} if isinstance(entry, str) else entry
        line, previous = encode_line(number, previous, entry)
        lines.append(line)
    folder.mkdir(exist_ok=True)
    path = folder / f"{name}.journal"
    path.write_bytes(b"".join(lines))
    return path


def task_menu(loop, services, scores=SCORES, language="en") -> Screen:
    """Return the task menu of a trainee with these scores."""
    for number, score in enumerate(scores):
        write_scored(services.records, number, score)
    preferences = Preferences(language=language)
    presenter = FlowPresenter(loop, services, DEFAULT_BINDINGS, preferences)
    session = presenter._session
    session.trainee = TRAINEE
    session.pages.show(ExperimentPage(session))
    screen = presenter._flow.screen()
    presenter.close()
    return screen
