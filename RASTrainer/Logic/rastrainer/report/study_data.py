"""What a report is about: the trials of a study, from its database or from a CSV file."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from rastrainer.ctps import Trial
from rastrainer.errors import InputError
from rastrainer.experiment.study_progress import QuestionnaireAnswers, StudyProgress
from rastrainer.experiment.study_protocol import StudyProtocol
from rastrainer.protocol import TRIAL_RUN
from rastrainer.registration import RIGID
from rastrainer.report.study_notes import StudyNotes, read_notes
from rastrainer.study import Study
from rastrainer.study_values import StoredTrial
from rastrainer.trial_files import read_trials


@dataclass(frozen=True)
class TrialRow:
    """One trial of a report.

    Attributes:
        trainee: Pseudonym.
        mode: Such as `desktop`.
        task: Its name.
        number: Which of the trainee's trials in this mode it was, from 1.
        values: What was measured, by name; see `rastrainer.report.outcomes`.
        trial_id: UUID; "" in files that know none.
        started_utc: ISO 8601; "" where unknown.
    """

    trainee: str
    mode: str
    task: str
    number: int
    values: Mapping[str, float]
    trial_id: str = ""
    started_utc: str = ""


@dataclass(frozen=True)
class StudyData:
    """Everything a report tells of.

    Attributes:
        title: For people.
        trials: But the trial runs.
        mean_ct_s: Mean completion times that CTPS shall use instead of the trials' own, by mode.
        notes: What is known about the study beside its numbers; None where nothing is.
        protocol: None where trainees practiced freely.
        answers: Answered questionnaires.
        skipped: Trainee, step and reason of each step that was left out.
        without_consent: How many trainees are left out because they did not agree to research.
        versions: Of the programs that made the records, name → different versions.
        has_order: Whether the order of the trials is known.
    """

    title: str
    trials: tuple[TrialRow, ...]
    mean_ct_s: Mapping[str, float] = field(default_factory=dict)
    notes: StudyNotes | None = None
    protocol: StudyProtocol | None = None
    answers: tuple[QuestionnaireAnswers, ...] = ()
    skipped: tuple[tuple[str, str, str], ...] = ()
    without_consent: int = 0
    versions: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    has_order: bool = False

    @property
    def modes(self) -> tuple[str, ...]:
        """Modes in the order of their first trial."""
        return tuple(dict.fromkeys(trial.mode for trial in self.trials))

    @property
    def trainees(self) -> tuple[str, ...]:
        """Pseudonyms in the order of their first trial."""
        return tuple(dict.fromkeys(trial.trainee for trial in self.trials))

    @property
    def tasks(self) -> tuple[str, ...]:
        """Tasks by name; numbers in them count as numbers."""
        return tuple(sorted({trial.task for trial in self.trials}, key=_by_number))

    def with_mean_times(self, mean_ct_s: Mapping[str, float]) -> StudyData:
        """Return the study with further mean completion times for CTPS, by mode."""
        return replace(self, mean_ct_s={**self.mean_ct_s, **mean_ct_s})

    def of_mode(self, mode: str) -> list[TrialRow]:
        """Return the trials of a mode."""
        return [trial for trial in self.trials if trial.mode == mode]

    def ctps_trials(self, mode: str) -> list[Trial]:
        """Return the trials of a mode as CTPS takes them; those without a registration lack."""
        return [
            Trial(t.mode, t.trainee, t.task, t.values["completion_time_s"], t.values["rmse_mm"])
            for t in self.of_mode(mode)
            if "rmse_mm" in t.values
        ]


def read_study_data(path: Path) -> StudyData:
    """Read a study's database, or a CSV file with the header `mode,subject,task,ct,rmse`.

    Beside a CSV file `NAME.csv`, notes are read from `NAME.json` if it is there.

    Raises:
        InputError: the file cannot be used, or holds no trials of anyone who consents.
    """
    if not path.is_file():
        raise InputError(f"There is no file {path}.")
    data = _from_csv(path) if path.suffix.lower() == ".csv" else _from_database(path)
    if not data.trials:
        raise InputError(
            f"The study {path} holds no trials of trainees who agreed to research "
            f"({data.without_consent} did not)."
        )
    return data


def _from_csv(path: Path) -> StudyData:
    notes = read_notes(path.with_suffix(".json"))
    counts: dict[tuple[str, str], int] = defaultdict(int)
    rows = []
    for trial in read_trials(path):
        counts[trial.mode, trial.subject] += 1
        values = {"completion_time_s": trial.completion_time_s, "rmse_mm": trial.rmse_mm}
        number = counts[trial.mode, trial.subject]
        rows.append(TrialRow(trial.subject, trial.mode, trial.task, number, values))
    return StudyData(
        title=notes.title if notes else path.stem,
        trials=tuple(rows),
        mean_ct_s=notes.mean_ct_s if notes else {},
        notes=notes,
    )


def _from_database(path: Path) -> StudyData:
    with Study.open(path) as study:
        progress = StudyProgress(study)
        protocol = progress.protocol()
        everyone = (*study.trainees(), *study.trainees(archived=True))
        consenting = {trainee.pseudonym for trainee in everyone if trainee.consent}
        trials, versions = [], defaultdict(set)
        for pseudonym in sorted(consenting):
            counts: dict[str, int] = defaultdict(int)
            for stored in study.history(pseudonym):
                if stored.record.task == TRIAL_RUN:
                    continue
                counts[stored.record.mode] += 1
                trials.append(trial_row(stored, counts[stored.record.mode]))
                for name, version in stored.record.versions.items():
                    versions[name].add(version)
        enrolled = [name for name in progress.enrolled() if name in consenting]
        return StudyData(
            title=protocol.title if protocol else path.stem,
            trials=tuple(trials),
            protocol=protocol,
            answers=tuple(a for a in progress.answers() if a.trainee in consenting),
            skipped=tuple(
                (name, entry.step, str(entry.details.get("reason", "")))
                for name in enrolled
                for entry in progress.progress(name).skipped
            ),
            without_consent=len(everyone) - len(consenting),
            versions={name: tuple(sorted(found)) for name, found in sorted(versions.items())},
            has_order=True,
        )


def trial_row(stored: StoredTrial, number: int) -> TrialRow:
    """Return a stored trial as a row of a report."""
    record, rigid, score = stored.record, stored.registrations.get(RIGID), stored.score
    values = {"completion_time_s": record.completion_time_s, **stored.motion}
    if rigid is not None:
        values["rmse_mm"] = rigid.fre_mm
        if rigid.expected_tre_mm is not None:
            values["expected_tre_mm"] = rigid.expected_tre_mm
    if score is not None:
        values["score"] = score.score
    if stored.true_tre_mm is not None:
        values["true_tre_mm"] = stored.true_tre_mm
    return TrialRow(
        trainee=record.trainee,
        mode=record.mode,
        task=record.task,
        number=number,
        values=values,
        trial_id=record.trial_id,
        started_utc=record.started_utc,
    )


def _by_number(task: str) -> tuple[str, int]:
    digits = task[len(task.rstrip("0123456789")) :]
    return task[: len(task) - len(digits)], int(digits[:9] or 0)
