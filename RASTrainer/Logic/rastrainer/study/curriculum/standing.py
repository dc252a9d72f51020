"""Where a trainee stands in a curriculum, and which assignment should come next.

Everything follows from the curriculum and the trainee's trials, so that nothing more is stored.
Scores of different versions are not compared: a goal is reached by trials of one version, and stays
reached when a newer version follows. An aborted trial with a touch fails in each.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import fmean

from rastrainer.procedure.score import PROCEDURE_SCORE_VERSION
from rastrainer.protocol import AssignmentState, GoalKind
from rastrainer.registration.methods import RegistrationMethod
from rastrainer.study.curriculum.counted_trials import CountedTrial
from rastrainer.study.curriculum.curriculum import Assignment, Curriculum
from rastrainer.trial.scoring import passes, score_version
from rastrainer.trial.trainee_progress import competence_of

PassMarkOf = Callable[[str], "float | None"]
"""From a version of the score to the mark that passes; None where there is none."""
RECENT = 3
"""How many of the latest trials of an assignment it is compared with others by."""
WHOLE_WAY = 100


@dataclass(frozen=True)
class AssignmentStanding:
    """Where a trainee stands with an assignment.

    Attributes:
        assignment: That is meant.
        state: Locked, open or reached.
        done: Trials in a row that pass now, or percent of the way to competence.
        needed: How many there have to be.
        mark: Score that passes a trial of the present version; None without one.
        played: Trials of the present version, aborted ones included.
        mean: Of the latest scores of the present version; None before the first.
        missing: Names of the assignments that it waits for.
        weakest: Part of the score that cost most in the latest trials; "" before the first.
    """

    assignment: Assignment
    state: AssignmentState
    done: int
    needed: int
    mark: float | None
    played: int = 0
    mean: float | None = None
    missing: tuple[str, ...] = ()
    weakest: str = ""

    @property
    def shortfall(self) -> float:
        """Points from the latest mean up to the mark; infinite before the first trial.

        Without a mark it is infinitely little: practice leads to no goal there.

        Drawing the mean of few trials toward that of all improved nothing in simulated courses
        (`Testing/error_rates/curricula.py`).
        """
        if self.mark is None:
            return -math.inf
        return math.inf if self.mean is None else self.mark - self.mean


@dataclass(frozen=True)
class CurriculumStanding:
    """Where a trainee stands in a curriculum.

    Attributes:
        curriculum: That is meant.
        standings: In its order.
        played: Trials of the present versions, each once however many assignments it counts for.
    """

    curriculum: Curriculum
    standings: tuple[AssignmentStanding, ...]
    played: int

    @property
    def reached(self) -> int:
        """How many assignments are reached."""
        return sum(each.state is AssignmentState.REACHED for each in self.standings)

    @property
    def next_best(self) -> AssignmentStanding | None:
        """The assignment to practice next; None when no open one is left.

        It is the weakest of the open ones: the one whose latest mean is farthest below its mark;
        one that was never played comes first, and of equal ones the first of the curriculum.
        """
        is_open = [each for each in self.standings if each.state is AssignmentState.OPEN]
        return max(is_open, key=lambda each: each.shortfall, default=None)


def standing_in(
    curriculum: Curriculum, trials: Sequence[CountedTrial], pass_mark_of: PassMarkOf
) -> CurriculumStanding:
    """Return where a trainee stands.

    Args:
        curriculum: That is meant.
        trials: Of the trainee, in order of starting.
        pass_mark_of: The study's pass mark, for goals without a mark of their own.
    """
    reached: set[str] = set()
    standings = []
    for assignment in curriculum.assignments:
        own = [trial for trial in trials if trial.counts_for(assignment)]
        missing = tuple(name for name in assignment.after if name not in reached)
        standing = _standing(assignment, own, missing, pass_mark_of)
        if standing.state is AssignmentState.REACHED:
            reached.add(assignment.name)
        standings.append(standing)
    played = sum(
        any(_is_comparable(trial, each) for each in curriculum.assignments) for trial in trials
    )
    return CurriculumStanding(curriculum, tuple(standings), played)


def _is_comparable(trial: CountedTrial, assignment: Assignment) -> bool:
    """Return whether a trial counts for an assignment with a score of the present version."""
    is_present = trial.is_aborted or trial.version == _present_version(assignment)
    return is_present and trial.counts_for(assignment)


def _standing(
    assignment: Assignment,
    own: Sequence[CountedTrial],
    missing: tuple[str, ...],
    pass_mark_of: PassMarkOf,
) -> AssignmentStanding:
    present = _present_version(assignment)

    def of_version(version: str) -> list[CountedTrial]:
        return [trial for trial in own if trial.is_aborted or trial.version == version]

    def progress(version: str) -> tuple[bool, int]:
        mark = mark_of(version)
        return (False, 0) if mark is None else _progress(assignment, of_version(version), mark)

    def mark_of(version: str) -> float | None:
        return pass_mark_of(version) if assignment.mark is None else assignment.mark

    earlier = {trial.version for trial in own} - {present, ""}
    is_reached, done = progress(present)
    is_reached = is_reached or any(progress(version)[0] for version in earlier)
    comparable = of_version(present)
    recent = comparable[-RECENT:]
    needed = assignment.trials if assignment.goal is GoalKind.SCORE else WHOLE_WAY
    unlocked = AssignmentState.REACHED if is_reached else AssignmentState.OPEN
    return AssignmentStanding(
        assignment,
        AssignmentState.LOCKED if missing else unlocked,
        needed if is_reached else done,
        needed,
        mark_of(present),
        len(comparable),
        fmean(trial.score for trial in recent) if recent else None,
        missing,
        _weakest([trial for trial in comparable if not trial.is_aborted][-RECENT:]),
    )


def _present_version(assignment: Assignment) -> str:
    if assignment.procedure:
        return PROCEDURE_SCORE_VERSION
    return score_version(RegistrationMethod(assignment.method))


def _progress(
    assignment: Assignment, trials: Sequence[CountedTrial], mark: float
) -> tuple[bool, int]:
    """Return whether trials of one version reach the goal, and how far they are now."""
    passed = [passes(trial.score, trial.acceptable, mark) for trial in trials]
    if assignment.goal is GoalKind.COMPETENT:
        chart = competence_of([not each for each in passed])
        share = chart.scores[-1] / chart.limit if chart.scores else 0.0
        # Rounded down: the whole way is shown only at competence.
        return chart.competent_at is not None, min(int(WHOLE_WAY * share), WHOLE_WAY - 1)
    longest = row = 0
    for each in passed:
        row = row + 1 if each else 0
        longest = max(longest, row)
    return longest >= assignment.trials, min(row, assignment.trials)


def _weakest(trials: Sequence[CountedTrial]) -> str:
    """Return the part of the score with the least geometric mean, which costs most; "" if none."""
    names = dict.fromkeys(name for trial in trials for name in trial.parts)
    means = {
        name: fmean(math.log(max(trial.parts.get(name, 1.0), 1e-9)) for trial in trials)
        for name in names
    }
    return min(means, key=lambda name: means[name], default="")
