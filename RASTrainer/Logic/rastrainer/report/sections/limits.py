"""What cannot be concluded."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.number_text import counted
from rastrainer.report.html.markup import bullets, heading, section
from rastrainer.report.results.comparisons import ModeComparison
from rastrainer.statistics.few_subjects import what_cannot_be_concluded
from rastrainer.study.outcomes import mode_title, task_title
from rastrainer.study.study_data import StudyData
from rastrainer.trial.scoring import LONG_PAUSE_S


def limits(data: StudyData, comparisons: Sequence[ModeComparison]) -> str:
    """Return the section."""
    sentences = ["No trainee did two modes: nothing is said about their difference."]
    if comparisons:
        largest = max(comparisons, key=lambda one: (one.result is not None, len(one.trainees)))
        sentences = what_cannot_be_concluded(
            len(largest.trainees), largest.result, largest.order is not None
        )
    sentences += _missing(data) + _paused(data)
    if data.without_consent:
        sentences.append(
            f"Left out: {counted(data.without_consent, 'trainee')} who did not agree to research."
        )
    if data.outside_protocol:
        sentences.append(
            f"Left out: {counted(data.outside_protocol, 'trial')} that the protocol had not asked "
            "for."
        )
    sentences.append(
        "CTPS depends on the cohort and rises with slower completion; differences in CTPS are not "
        "differences in skill."
    )
    parts = [bullets(sentences)]
    if data.skipped:
        parts += [
            heading("Steps of the protocol that were left out"),
            bullets([f"{who}, {step}: {reason}" for who, step, reason in data.skipped]),
        ]
    return section("What cannot be concluded", *parts)


def _paused(data: StudyData) -> list[str]:
    count = sum(trial.values.get("pause_time_s", 0.0) > LONG_PAUSE_S for trial in data.trials)
    if not count:
        return []
    return [
        f"{count} of {len(data.trials)} trials were paused for more than {LONG_PAUSE_S:g} s in "
        "all. Completion time and score leave pauses out: time to think that others did not have."
    ]


def _missing(data: StudyData) -> list[str]:
    """Say which tasks some trainees lack, since means over other tasks do not compare."""
    lacking = []
    for mode in data.modes:
        own = data.of_mode(mode)
        trainees = {trial.trainee for trial in own}
        for task in data.tasks:
            missing = len(trainees) - len({t.trainee for t in own if t.task == task})
            if missing:
                who = f"{missing} of {counted(len(trainees), 'trainee')}"
                lacking.append(f"{task_title(task)}, {mode_title(mode)}, of {who}")
    if not lacking:
        return []
    return [
        f"Trials are missing: {'; '.join(lacking)}. These trainees count with the tasks that they "
        "did in both modes."
    ]
