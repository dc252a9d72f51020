"""How many trials were started and how they ended, including aborted ones."""

from __future__ import annotations

from collections import Counter

from rastrainer.number_text import counted
from rastrainer.report.elements.markup import bullets, heading, paragraph, section, table
from rastrainer.study.database.aborted_trials import StoredAborted
from rastrainer.study.outcomes import mode_title, task_title
from rastrainer.study.study_data import StudyData

HEADER = [
    *("trainee", "mode", "task", "started (n)", "finished"),
    *("aborted before all touches", "aborted after all touches"),
]


def started_trials(data: StudyData) -> str:
    """Return the section; "" if only finished trials are known, as in a CSV file."""
    if not data.has_order:
        return ""
    scored = [stored for stored in data.aborted if not stored.record.is_trial_run]
    runs = len(data.aborted) - len(scored)
    total = len(data.trials) + len(scored)
    parts = [paragraph(f"{len(data.trials)} of {total} started trials were finished.")]
    if scored:
        parts.append(table([HEADER], _rows(data, scored)))
        failed = sum(stored.record.counts_as_failed for stored in scored)
        parts.append(
            paragraph(
                "Tasks of trainees who aborted none are left out of the table. An aborted trial "
                f"with a touch ({failed} of {len(scored)}) counts as not passed in the pass mark's "
                "LC-CUSUM; it has no score and no time for anything else here, so that what "
                "follows is about the finished trials.",
                "small",
            )
        )
    if runs:
        parts.append(
            paragraph(
                f"{counted(runs, 'trial run')} {'was' if runs == 1 else 'were'} ended without "
                "being registered, as is usual; none counts."
            )
        )
    if repeats := _repeats(scored):
        parts += [heading("Steps of the protocol that were played again"), bullets(repeats)]
    silent = sum(not stored.repeat_reason for stored in scored)
    if data.protocol is not None and silent:
        parts.append(
            paragraph(
                f"For {counted(silent, 'aborted trial')} no reason of a repeat is stored: the step "
                "was not played again, was left out, or its repeat had arrived before.",
                "small",
            )
        )
    return section("Started trials", *parts)


def _rows(data: StudyData, aborted: list[StoredAborted]) -> list[list[str]]:
    finished = Counter((trial.trainee, trial.mode, trial.task) for trial in data.trials)
    early: Counter[tuple[str, str, str]] = Counter()
    late: Counter[tuple[str, str, str]] = Counter()
    for stored in aborted:
        record = stored.record
        counter = late if record.is_after_all_touches else early
        counter[record.trainee, record.mode, record.task] += 1
    keys = sorted({*early, *late})
    rows = [
        [who, mode_title(mode), task_title(task), *_counts(finished[key], early[key], late[key])]
        for key in keys
        for who, mode, task in [key]
    ]
    whole = _counts(len(data.trials), sum(early.values()), sum(late.values()))
    return [*rows, ["all trials of the study", "", "", *whole]]


def _counts(finished: int, early: int, late: int) -> list[str]:
    return [str(finished + early + late), str(finished), str(early), str(late)]


def _repeats(aborted: list[StoredAborted]) -> list[str]:
    return [
        f"{stored.record.trainee}, {stored.step}, aborted with {len(stored.record.points)} points "
        f"touched ({stored.record.reason}): {stored.repeat_reason}"
        for stored in aborted
        if stored.repeat_reason
    ]
