"""The virtual cohort that is simulated into a study, stored so that it can resume.

The plan is stored before the first trial, and its completion after the last, so an incomplete study
is recognized after any interruption.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import json_text, utc_now
from rastrainer.trial.analysis import TrialAnalysis


class IncompleteStudyError(InputError):
    """The study is an incomplete virtual cohort."""


class CohortStore:
    """The virtual cohort of one study. One thread may use it."""

    def __init__(self, study: Study) -> None:
        self._study, self._database = study, study.database

    def start(self, plan: Mapping[str, Any], planned_trials: int) -> None:
        """Store the plan, from which all trials follow; the same again changes nothing."""
        text = json_text(plan)
        with self._database.writing():
            row = self._database.row("SELECT plan_json FROM cohort")
            if row is not None and row[0] == text:
                return
            if row is not None:
                stored, new = decode_finite_json(row[0]), decode_finite_json(text)
                names = [each for each in {**stored, **new} if stored.get(each) != new.get(each)]
                raise InputError(
                    "The folder contains a virtual cohort that was started with other options "
                    f"(different: {', '.join(names)}). Resume it with the options that it was "
                    "started with, or choose an empty folder."
                )
            for table in ("trainees", "study_protocol"):
                if self._database.row(f"SELECT 1 FROM {table}") is not None:
                    raise InputError(
                        "The folder contains a study that is no virtual cohort; choose an "
                        "empty folder."
                    )
            self._database.insert("cohort", id=1, plan_json=text, planned_trials=planned_trials)

    def gap(self) -> str:
        """Return a sentence about missing trials; "" if the cohort is complete, or there is none.

        It stays complete if trainees were deleted since.
        """
        with self._database.reading():
            row = self._database.row("SELECT planned_trials FROM cohort WHERE finished_utc IS NULL")
            if row is None:
                return ""
            stored, stuck = (
                self._database.row(f"SELECT count(*) FROM {table}")[0]
                for table in ("trials", "stuck_trials")
            )
        and_stuck = f", and {stuck} got stuck" if stuck else ""
        return (
            f"This virtual cohort is incomplete: {stored} of {row[0]} trials are stored{and_stuck}."
        )

    def has_played(self, trial_id: str) -> bool:
        with self._database.reading():
            is_known = any(self._study.has(each, trial_id) for each in ("stuck_trials", "trials"))
            return is_known or self._study.is_deleted(trial_id)

    def add(self, analysis: TrialAnalysis) -> None:
        """Store a finished trial with all results, the truth included, in one transaction."""
        record, study = analysis.record, self._study
        with self._database.writing():
            if not study.has_trainee(record.trainee):
                study.create_trainee(record.trainee, consent=True)
            # Not new where a second process plays the same cohort; its trial is the same.
            study.add_trial(
                *(record, analysis.fits.values(), analysis.target_errors, analysis.score),
                procedure=analysis.procedure,
                truth=analysis.truth,
            )

    def add_stuck(self, trial_id: str) -> None:
        self._database.insert("stuck_trials", is_once=True, trial_id=trial_id)

    def finish(self) -> None:
        self._database.change(
            "UPDATE cohort SET finished_utc = ? WHERE finished_utc IS NULL", utc_now()
        )
