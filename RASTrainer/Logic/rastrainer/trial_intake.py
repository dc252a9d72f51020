"""A delivered trial goes into the study: checked, registered, then stored, all in one call.

It may run in a thread of its own: it works on plain data and the study that it is given.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.errors import InputError
from rastrainer.study import Study
from rastrainer.trial_analysis import TrialAnalysis
from rastrainer.trial_record import TrialRecord


@dataclass(frozen=True)
class Intake:
    """A trial that is safe in the study.

    Attributes:
        record: the trial.
        analysis: its registration; None where it is not to be scored now, or cannot be.
        problem: why it cannot be registered, a sentence; empty otherwise.
    """

    record: TrialRecord
    analysis: TrialAnalysis | None = None
    problem: str = ""


def take_in(
    value: Mapping[str, Any],
    study: Study,
    analyze: Callable[[TrialRecord], TrialAnalysis],
    is_being_told: bool = False,
) -> Intake:
    """Store a trial with its registration, once; what is known already is not scored again.

    Args:
        value: the trial as it was delivered.
        study: in which it is stored.
        analyze: registers a record; `InputError` where that cannot be.
        is_being_told: whether its registration or score is on its way to the simulator.

    Raises:
        InputError: it is no record of a trial, or cannot be stored.
        DeletedTrialError: it was deleted with its trainee.
    """
    record = TrialRecord.from_json(value)
    is_new = study.check_trial(record)
    if not is_new and (is_being_told or study.is_revealed(record.trial_id)):
        return Intake(record)
    try:
        analysis = analyze(record)
    except InputError as error:
        study.add_trial(value)
        return Intake(record, problem=str(error))
    study.add_trial(value, analysis.fits.values(), analysis.target_errors)
    return Intake(record, analysis)
