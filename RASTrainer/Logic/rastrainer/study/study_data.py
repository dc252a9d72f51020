"""The data of a report: the trials of a study, from its database or a CSV file."""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN
from rastrainer.registration.fits import RIGID
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import CurriculumStanding
from rastrainer.study.database.cohort_store import CohortStore, IncompleteStudyError
from rastrainer.study.database.database import StudyPlace
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.protocol.steps import objections_to
from rastrainer.study.protocol.study_progress import QuestionnaireAnswers, StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.ratings import Rating, RatingStore
from rastrainer.study_messages import StudyStep
from rastrainer.trial.ctps import StudyNotes, read_notes, read_trials
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import AbortedTrial, TrialRecord
from rastrainer.trial.scoring import TrialScore
from rastrainer.trial.trial_row import TrialRow


@dataclass(frozen=True)
class StudyData:
    """The data of a report; `gap` names the missing part of its virtual cohort.

    Attributes:
        trials: Without trial runs; for trainees in a protocol, only trials of its steps.
        mean_ct_s: Mean completion times for CTPS instead of the trials' own, by mode.
        skipped: Trainee, step and reason of each skipped step.
        objections: Trainee, trial and reasons, for each trial that broke a rule of the protocol.
        aborted: Including trial runs, by trainee in order.
        undelivered: First and last numbers of trials that never arrived, by their simulator's
            series.
        standings: Of active trainees in their curricula, by pseudonym.
        drills: Of consenting trainees, in order of time; in a protocol, only drills of its steps.
    """

    title: str
    trials: tuple[TrialRow, ...]
    mean_ct_s: Mapping[str, float] = field(default_factory=dict)
    notes: StudyNotes | None = None
    protocol: StudyProtocol | None = None
    answers: tuple[QuestionnaireAnswers, ...] = ()
    skipped: tuple[tuple[str, str, str], ...] = ()
    outside_protocol: int = 0
    objections: tuple[tuple[str, str, str], ...] = ()
    without_consent: int = 0
    versions: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    has_order: bool = False
    gap: str = ""
    aborted: tuple[AbortedTrial, ...] = ()
    undelivered: Mapping[str, tuple[tuple[int, int], ...]] = field(default_factory=dict)
    ratings: tuple[Rating, ...] = ()
    standings: Mapping[str, CurriculumStanding] = field(default_factory=dict)
    drills: tuple[DrillRecord, ...] = ()

    @property
    def modes(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(trial.mode for trial in self.trials))

    @property
    def trainees(self) -> tuple[str, ...]:
        done: tuple[TrialRow | DrillRecord, ...] = (*self.trials, *self.drills)
        return tuple(dict.fromkeys(each.trainee for each in done))

    @property
    def tasks(self) -> tuple[str, ...]:
        """Tasks by name, with numbers in numerical order."""
        return tuple(sorted({trial.task for trial in self.trials}, key=_by_number))

    def of_mode(self, mode: str) -> list[TrialRow]:
        return [trial for trial in self.trials if trial.mode == mode]

    def ctps_trials(self, mode: str) -> list[TrialRow]:
        return [trial for trial in self.of_mode(mode) if "rmse_mm" in trial.values]


def read_study_data(place: StudyPlace, allow_incomplete: bool = False) -> StudyData:
    """Read a study's database, or a CSV file with the header `mode,subject,task,ct,rmse`.

    Notes next to a CSV file `NAME.csv` are read from `NAME.json`.
    """
    if isinstance(place, Path) and not place.is_file():
        raise InputError(f"There is no file {place}.")
    if isinstance(place, Path) and place.suffix.lower() == ".csv":
        data = _from_csv(place)
    else:
        data = _from_database(place)
    if data.gap and not allow_incomplete:
        raise IncompleteStudyError(
            f"{data.gap} Simulate it again into the same folder with the same options: only the "
            "missing trials are played."
        )
    if not data.trials and not data.drills:
        count = data.without_consent
        remedy = f" ({count} did not): note in 3D Slicer, Trainees, who consents." if count else "."
        raise InputError(
            f"The study {place} contains no trials of trainees who consented to research{remedy}"
        )
    return data


def _from_csv(path: Path) -> StudyData:
    notes = read_notes(path.with_suffix(".json"))
    return StudyData(
        title=notes.title if notes else path.stem,
        trials=tuple(read_trials(path)),
        mean_ct_s=notes.mean_ct_s if notes else {},
        notes=notes,
    )


def _from_database(place: StudyPlace) -> StudyData:
    with Study.open_for_reading(place) as study:
        progress = StudyProgress(study)
        protocol = progress.protocol()
        everyone = study.trainees(archived=None)
        consenting = sorted(trainee.pseudonym for trainee in everyone if trainee.consent)
        played = {name: progress.played(name) for name in progress.enrolled() if name in consenting}
        trials, versions, beside, objections = [], defaultdict(set), 0, []
        drills: list[DrillRecord] = []
        rateable: set[str] = set()
        for pseudonym in consenting:
            history = [t for t in study.history(pseudonym) if t.record.task != TRIAL_RUN]
            rateable |= {trial.record.trial_id for trial in history}
            own, done = played.get(pseudonym), study.drills(pseudonym)
            if own is not None:
                beside += sum(drill.trial_id not in own.counted_trials for drill in done)
                done = tuple(drill for drill in done if drill.trial_id in own.counted_trials)
                others = [t for t in history if t.record.trial_id not in own.counted_trials]
                history = [t for t in history if t.record.trial_id in own.counted_trials]
                beside += len(others)
                objections += [entry for t in others if (entry := _objected(t.record, own.steps))]
            trials += trial_rows(history)
            drills += done
            for given in [t.record.versions for t in history] + [d.versions for d in done]:
                for name, version in given.items():
                    versions[name].add(version)
        return StudyData(
            title=protocol.title if protocol else study.database.name,
            trials=tuple(trials),
            protocol=protocol,
            answers=tuple(a for a in progress.answers() if a.trainee in consenting),
            skipped=tuple(
                (name, entry.step, str(entry.details.get("reason", "")))
                for name, own in played.items()
                for entry in own.skipped
            ),
            outside_protocol=beside,
            objections=tuple(objections),
            without_consent=len(everyone) - len(consenting),
            versions={name: tuple(sorted(found)) for name, found in sorted(versions.items())},
            has_order=True,
            gap=CohortStore(study).gap(),
            aborted=tuple(stored for name in consenting for stored in study.aborted(name)),
            undelivered=study.undelivered(),
            standings={
                name: each
                for name, each in CurriculumStore(study).standings().items()
                if name in consenting
            },
            drills=tuple(drills),
            ratings=tuple(r for r in RatingStore(study).ratings() if r.trial_id in rateable),
        )


def _objected(record: TrialRecord, steps: Iterable[StudyStep]) -> tuple[str, str, str] | None:
    of_task = (s for s in steps if (s.task, s.mode) == (record.task, record.mode))
    step = next(of_task, None)
    reasons = () if step is None else objections_to(step, record)
    what = f"{record.task}, {record.mode}, {record.started_utc}"
    return (record.trainee, what, "; ".join(reasons)) if reasons else None


def values_of(trials: Iterable[TrialRow], name: str) -> list[float]:
    return [trial.values[name] for trial in trials if name in trial.values]


def trial_rows(history: Iterable[StoredTrial]) -> list[TrialRow]:
    counts: Counter[str] = Counter()
    rows = []
    for stored in history:
        is_run = stored.record.task == TRIAL_RUN
        counts[stored.record.mode] += not is_run
        rows.append(_trial_row(stored, 0 if is_run else counts[stored.record.mode]))
    return rows


def _trial_row(stored: StoredTrial, number: int) -> TrialRow:
    record, rigid, score = stored.record, stored.registrations.get(RIGID), stored.score
    values = {
        "completion_time_s": record.completion_time_s,
        "refused_touches": record.rejected_touches,
        "undone_touches": record.undone_touches,
        **record.motion,
    }
    if rigid is not None:
        values["rmse_mm"] = rigid.fre_mm
        if rigid.expected_tre_mm is not None:
            values["expected_tre_mm"] = rigid.expected_tre_mm
            values["tre_common_bias_sd_mm"] = rigid.common_bias_sd_mm
        if rigid.tre_interval_mm is not None:
            values["tre_low_mm"], values["tre_high_mm"] = rigid.tre_interval_mm
    if score is not None:
        values["score"] = score.score
        # The safety metrics are among the motion metrics.
        values |= _score_parts(score)
    if stored.true_tre_mm is not None:
        values["true_tre_mm"] = stored.true_tre_mm
    if not record.skin.is_none:
        values["skin_shift_mm"] = record.skin.shift_mm
        values["skin_indentation_mm"] = record.skin.indentation_mm
    if stored.procedure is not None:
        values |= _procedure_values(stored.procedure)
    return TrialRow.of(
        record,
        number=number,
        values=values,
        score_version="" if score is None else score.version,
        acceptable=score is not None and score.acceptable,
        completed_utc=record.completed_utc,
        procedure=stored.procedure,
    )


def _procedure_values(procedure: ProcedureOutcome) -> dict[str, float]:
    """Return the outcomes of a procedure; root mean squares are over its trajectories."""
    analysis, score = procedure.analysis, procedure.score
    lines = analysis.trajectories
    by_hand = [one.target_point_error.by_hand_mm for one in lines if not one.self_aligned]
    rms = math.sqrt(sum(length**2 for length in by_hand) / len(by_hand)) if by_hand else 0.0
    by_registration = analysis.target_point_error_by_registration_rms_mm
    return {
        "procedure_score": score.score,
        "procedure_acceptable": float(score.acceptable),
        "procedure_trajectories": float(len(lines)),
        "procedure_duration_s": analysis.duration_s,
        "procedure_target_rms_mm": analysis.target_point_error_rms_mm,
        "procedure_target_by_registration_rms_mm": by_registration,
        **({"procedure_target_by_hand_rms_mm": rms} if by_hand else {}),
        "procedure_self_aligned": float(analysis.self_aligned),
        "procedure_entry_rms_mm": analysis.entry_point_error_rms_mm,
        "procedure_angle_rms_deg": analysis.angular_deviation_rms_deg,
        "procedure_alignments": float(analysis.alignments),
        "procedure_attempts": float(analysis.attempts),
        "procedure_plunge_mm": score.measures.plunge_mm,
        "procedure_hits": float(score.measures.hits),
    }


def _score_parts(score: TrialScore) -> dict[str, float]:
    parts = {
        "score_tre_mm": score.measures.tre_mm,
        "score_common_bias_mm": score.measures.common_bias_mm,
        "unshifted_tre_mm": score.unshifted_tre_mm,
        "score_time_desirability": score.time_desirability,
        "score_accuracy_desirability": score.accuracy_desirability,
        "score_safety_desirability": score.safety_desirability,
        "score_is_accurate": score.is_accurate,
        "score_is_unbiased": score.is_unbiased,
        "score_is_safe": score.is_safe,
        "score_reference_time_s": score.reference.time_s,
        "score_reference_tre_mm": score.reference.tre_mm,
        "score_limit_mm": score.reference.limit_mm,
    }
    return {name: float(value) for name, value in parts.items() if value is not None}


def _by_number(task: str) -> tuple[str, int]:
    name = task.rstrip("0123456789")
    return name, int(task[len(name) :][:9] or 0)
