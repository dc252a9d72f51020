"""Commands for what trainees should reach: `rastrainer curriculum` and `rastrainer pass-mark`."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from statistics import fmean

from rastrainer.errors import InputError
from rastrainer.files.writing import write_text
from rastrainer.number_text import fixed, percent
from rastrainer.protocol import RegistrationMethod
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import (
    CurriculumStanding,
    advice_of,
    goal_of,
    short_progress_of,
    title_of,
)
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_protocol import StudyProtocol, protocol_text
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.cli.printing import aligned
from rastrainer_simulator.statistics.pass_marks import pass_mark

HEADER = ("assignment", "trial", "so far", "goal", "after", "trials", "mean")


def follow_curriculum(arguments: argparse.Namespace) -> int:
    if arguments.set is not None and arguments.end:
        raise InputError("--set and --end exclude each other.")
    curriculum = None if arguments.set is None else Curriculum.read(arguments.set)
    who = arguments.trainee or ""
    if curriculum is not None or arguments.end:
        with Study.open(arguments.study, must_exist=True) as opened:
            CurriculumStore(opened).choose(curriculum, who)
        what = "no curriculum" if curriculum is None else f"“{curriculum.title}”"
        print(f"{who or 'Everybody'} follows {what} from now on.")
    with Study.open_for_reading(arguments.study) as opened:
        store = CurriculumStore(opened)
        standing = store.standing(who) if who else None
        found = {who: standing} if standing is not None else {} if who else store.standings()
    if not found and not arguments.end:
        print(f"{who or 'No trainee'} {'does not follow' if who else 'follows'} a curriculum.")
    for name, each in found.items():
        print(f"\n{_table(name, each)}")
    return 0


def _table(name: str, standing: CurriculumStanding) -> str:
    rows = [
        (
            each.name,
            title_of(each),
            short_progress_of(each),
            goal_of(each),
            ", ".join(each.after),
            str(each.played),
            "–" if each.mean is None else fixed(each.mean, 0),
        )
        for each in standing.standings
    ]
    reached = f"{standing.reached} of {len(standing.standings)} reached"
    title = f"{name}, {standing.curriculum.title}: {reached}. {advice_of(standing)}"
    return "\n".join((title, *aligned((HEADER, *rows), len(HEADER))))


LAST_TRIALS = 3


def compute_pass_mark(arguments: argparse.Namespace) -> int:
    both = sorted({*arguments.novices} & {*arguments.experts})
    if both:
        raise InputError(f"{both[0]} is named in both groups; name each person once, in one group.")
    with Study.open_for_reading(arguments.study) as opened:
        names = dict.fromkeys((*arguments.novices, *arguments.experts))
        attempts = {pseudonym: opened.attempts(pseudonym) for pseudonym in names}
    novices, experts, method = _mean_scores(attempts, arguments.novices, arguments.experts)
    aborted = sum(attempt.is_aborted for own in attempts.values() for attempt in own)
    mark = pass_mark(novices, experts)
    print(
        f"Pass mark {mark.score:.1f} of 100 (trials by {method.value}), from {len(novices)} "
        f"novices (mean {fmean(novices):.1f}) and {len(experts)} experts (mean "
        f"{fmean(experts):.1f}).\n"
        f"If both groups are normal, {percent(mark.passing_novices)} of novices would pass and "
        f"{percent(mark.failing_experts)} of experts fail; here it is "
        f"{percent(mark.observed_passing_novices)} and {percent(mark.observed_failing_experts)}."
    )
    if aborted:
        print(
            f"They aborted {aborted} trials after a touch; these have no score, so that people who "
            "abort bad trials seem better here."
        )
    if arguments.write is not None:
        # People are shown whole points, so the mark is in whole points.
        protocol = StudyProtocol.read(arguments.write)
        if method is not RegistrationMethod.FIDUCIALS:
            raise InputError(
                f"The mark is of trials registered by {method.value}, and a protocol's is for "
                f"fiducials: it is not written into {arguments.write}."
            )
        protocol = replace(protocol, pass_mark=float(round(mark.score)))
        write_text(arguments.write, protocol_text(protocol))
        print(f"{arguments.write}: the pass mark is {protocol.pass_mark:.0f} now.")
    return 0


def _mean_scores(
    attempts: Mapping[str, Sequence[TrialRow]], novices: Sequence[str], experts: Sequence[str]
) -> tuple[list[float], list[float], RegistrationMethod]:
    """Return the mean score of each person's last trials, by group, and the trials' method."""
    methods: set[RegistrationMethod] = set()
    means: list[list[float]] = []
    for group in (novices, experts):
        means.append([])
        for pseudonym in dict.fromkeys(group):
            trials = [one for one in attempts[pseudonym] if not one.is_aborted][-LAST_TRIALS:]
            if len(trials) < LAST_TRIALS:
                raise InputError(
                    f"{pseudonym} has {len(trials)} scored trials, and {LAST_TRIALS} are needed of "
                    "each."
                )
            methods |= {RegistrationMethod(trial.method) for trial in trials}
            means[-1].append(fmean(trial.score for trial in trials))
    if len(methods) > 1:
        names = " and ".join(sorted(method.value for method in methods))
        raise InputError(
            f"The last {LAST_TRIALS} trials of these people were registered by {names}, whose "
            "scores cannot be compared: no mark can be computed from them."
        )
    return means[0], means[1], methods.pop()
