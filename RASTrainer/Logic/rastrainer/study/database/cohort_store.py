"""The virtual cohort that is simulated into a study, stored so that it can resume.

The plan is stored before the first trial, and its completion after the last, so an incomplete study
is recognized whatever interrupted it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import json_text, utc_now
from rastrainer.trial.analysis import TrialAnalysis


class IncompleteStudyError(InputError):
    """The study is an incomplete virtual cohort."""


@dataclass(frozen=True)
class CohortState:
    """The progress of a virtual cohort, in trials.

    Attributes:
        stuck: Those in which the virtual trainee did not reach a fiducial.
        is_finished: Whether all trials were played, also if trainees were deleted since.
    """

    planned: int
    stored: int
    stuck: int
    is_finished: bool

    @property
    def gap(self) -> str:
        """What is missing, as a sentence; "" if complete."""
        if self.is_finished:
            return ""
        stuck = f", and {self.stuck} got stuck" if self.stuck else ""
        return (
            f"This virtual cohort is incomplete: {self.stored} of {self.planned} trials are "
            f"stored{stuck}."
        )


class CohortStore:
    """The virtual cohort of one study. One thread may use it."""

    def __init__(self, study: Study) -> None:
        self._study, self._database = study, study.database

    def start(self, plan: Mapping[str, Any], planned_trials: int) -> None:
        """Store the plan, from which all trials follow; the same again changes nothing."""
        with self._database.writing() as connection:
            row = connection.execute("SELECT plan_json FROM cohort").fetchone()
            if row is None:
                for table in ("trainees", "study_protocol"):
                    if connection.execute(f"SELECT 1 FROM {table}").fetchone() is not None:
                        raise InputError(
                            "The folder contains a study that is no virtual cohort; choose an "
                            "empty folder."
                        )
                connection.execute(
                    "INSERT INTO cohort VALUES (1, ?, ?, ?, NULL)",
                    (json_text(plan), planned_trials, utc_now()),
                )
            elif row[0] != json_text(plan):
                _refuse_other_plan(*map(decode_finite_json, (row[0], json_text(plan))))

    def state(self) -> CohortState | None:
        """Return the progress of the cohort, or None if the study is no virtual cohort."""
        with self._database.reading() as connection:
            row = connection.execute("SELECT planned_trials, finished_utc FROM cohort").fetchone()
            if row is None:
                return None
            stored, stuck = (
                connection.execute(f"SELECT count(*) FROM {table}").fetchone()[0]
                for table in ("trials", "stuck_trials")
            )
        return CohortState(row[0], stored, stuck, row[1] is not None)

    def has_played(self, trial_id: str) -> bool:
        """Return whether a trial was played: stored, stuck, or deleted since."""
        with self._database.reading() as connection:
            query = "SELECT 1 FROM stuck_trials WHERE trial_id = ?"
            return (
                connection.execute(query, (trial_id,)).fetchone() is not None
                or self._study.is_deleted(trial_id)
                or self._study.has_trial(trial_id)
            )

    def add(self, analysis: TrialAnalysis) -> None:
        """Store a finished trial with all results, the truth included, in one transaction."""
        record, truth = analysis.record, analysis.truth
        if truth is None:
            raise ValueError("A virtual trial is stored with its truth.")
        study = self._study
        with study.database.writing():
            study.create_where_missing(record.trainee, consent=True)
            # Not new where a second process plays the same cohort; its trial is the same.
            if study.add_trial(record):
                study.add_results(
                    record.trial_id,
                    analysis.fits.values(),
                    analysis.target_errors,
                    analysis.score,
                    analysis.procedure,
                )
                study.set_truth(record.trial_id, truth.true_tre_mm, truth.head_to_world)

    def add_stuck(self, trial_id: str) -> None:
        """Note that a trial was played but not finished."""
        with self._database.writing() as connection:
            connection.execute(
                "INSERT INTO stuck_trials VALUES (?) ON CONFLICT DO NOTHING", (trial_id,)
            )

    def finish(self) -> None:
        """Note that all trials were played."""
        with self._database.writing() as connection:
            connection.execute(
                "UPDATE cohort SET finished_utc = ? WHERE finished_utc IS NULL", (utc_now(),)
            )


def _refuse_other_plan(stored: Mapping[str, Any], plan: Mapping[str, Any]) -> None:
    names = [name for name in {**stored, **plan} if stored.get(name) != plan.get(name)]
    raise InputError(
        f"The folder contains a virtual cohort that was started with other options (different: "
        f"{', '.join(names)}). Resume it with the options that it was started with, or choose an "
        "empty folder."
    )
