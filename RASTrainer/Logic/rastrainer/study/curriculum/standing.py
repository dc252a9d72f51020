"""A trainee's standing in a curriculum, the assignment that should come next, and both in words.

Everything follows from the curriculum and the trainee's trials, so that nothing more is stored. An
aborted trial with a touch fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from rastrainer.number_text import fixed
from rastrainer.protocol import DECIDE, AssignmentState, GoalKind
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.database.values import day_of, moment
from rastrainer.study.protocol.steps import trial_title
from rastrainer.study_messages import WHOLE_WAY, Assignment, AssignmentStanding, CurriculumMessage
from rastrainer.trial import wording
from rastrainer.trial.scoring import passes
from rastrainer.trial.trial_feedback import competence_of
from rastrainer.trial.trial_row import TrialRow

PassMarkOf = Callable[[Assignment], "float | None"]
"""Maps an assignment to the study's pass mark for its trials; None if there is none."""
RECENT = 3
"""How many of its latest trials an assignment is compared by."""


@dataclass(frozen=True)
class CurriculumStanding:
    """A trainee's standing; a played trial is counted once, even if several assignments use it."""

    curriculum: Curriculum
    standings: tuple[AssignmentStanding, ...]
    played: int

    @property
    def reached(self) -> int:
        return sum(each.state is AssignmentState.REACHED for each in self.standings)

    @property
    def next_best(self) -> AssignmentStanding | None:
        """The assignment to practice next; None when no open one is left.

        It is the weakest open assignment, whose latest mean is farthest below its mark. An
        unplayed assignment comes first, an assignment without a mark last; ties keep their order.

        Drawing the mean of few trials toward the overall mean improved nothing in simulated courses
        (`Testing/error_rates/curricula.py`).
        """

        def shortfall(standing: AssignmentStanding) -> float:
            if standing.mark is None:
                return -math.inf
            return math.inf if standing.mean is None else standing.mark - standing.mean

        is_open = [each for each in self.standings if each.state is AssignmentState.OPEN]
        return max(is_open, key=shortfall, default=None)

    def message(self, trainee: str) -> CurriculumMessage:
        best = self.next_best
        name = "" if best is None else best.name
        return CurriculumMessage(trainee, self.curriculum.title, name, self.standings)


def by_curriculum(
    standings: Mapping[str, CurriculumStanding | None],
) -> dict[Curriculum, dict[str, CurriculumStanding]]:
    """Return the standings of trainees, by name, for each curriculum that is followed."""
    groups: dict[Curriculum, dict[str, CurriculumStanding]] = {}
    for name, standing in standings.items():
        if standing is not None:
            groups.setdefault(standing.curriculum, {})[name] = standing
    return groups


def standing_in(
    curriculum: Curriculum, trials: Sequence[TrialRow], pass_mark_of: PassMarkOf
) -> CurriculumStanding:
    """Return where a trainee stands by their trials and drills, each in order of starting.

    In a trial with a procedure, the procedure's score counts. Goals without a mark use the
    study's pass mark. A drill is passed by its error rates alone.
    """
    reached: dict[str, str] = {}
    standings = []
    for assignment in curriculum.assignments:
        own = [trial for trial in trials if _counts_for(trial, assignment)]
        standing = _standing(assignment, own, reached, pass_mark_of)
        if standing.state is AssignmentState.REACHED:
            reached[assignment.name] = standing.reached_utc
        standings.append(standing)
    played = sum(
        any(_counts_for(trial, each) for each in curriculum.assignments) for trial in trials
    )
    return CurriculumStanding(curriculum, tuple(standings), played)


def _counts_for(trial: TrialRow, assignment: Assignment) -> bool:
    if trial.is_aborted and trial.is_in_procedure and not assignment.procedure:
        return False
    procedure = assignment.procedure if trial.is_aborted else ""
    if trial.procedure is not None:
        procedure = trial.procedure.analysis.procedure
    kind = trial.scenario, trial.task, trial.mode, trial.method, procedure
    return assignment.is_played_as(*kind)


def _standing(
    assignment: Assignment,
    own: Sequence[TrialRow],
    reached: Mapping[str, str],
    pass_mark_of: PassMarkOf,
) -> AssignmentStanding:
    """Return where a trainee stands; `reached` has when those before it were reached, by name."""
    mark = pass_mark_of(assignment) if assignment.mark is None else assignment.mark
    reaching, done = (None, 0) if mark is None else _progress(assignment, own, mark)
    missing = tuple(name for name in assignment.after if name not in reached)
    needed = WHOLE_WAY if assignment.goal is GoalKind.COMPETENT else assignment.trials
    state = AssignmentState.OPEN if reaching is None else AssignmentState.REACHED
    reached_utc = ""
    if reaching is not None and not missing:
        gates = [reached[name] for name in assignment.after]
        reached_utc = max(filter(None, (reaching.started_utc, *gates)), key=moment, default="")
    recent = own[-RECENT:]
    return AssignmentStanding(
        **{**vars(assignment), "mark": mark},
        state=AssignmentState.LOCKED if missing else state,
        done=done if reaching is None else needed,
        needed=needed,
        played=len(own),
        mean=fmean(trial.score for trial in recent) if recent else None,
        missing=missing,
        weakest=_weakest([trial for trial in own if not trial.is_aborted][-RECENT:]),
        reached_utc=reached_utc,
    )


def _progress(
    assignment: Assignment, trials: Sequence[TrialRow], mark: float
) -> tuple[TrialRow | None, int]:
    """Return which of the trials reaches the goal, and how far they are now."""
    mark = 0.0 if assignment.task == DECIDE else mark
    passed = [passes(trial.score, trial.acceptable, mark) for trial in trials]
    if assignment.goal is GoalKind.COMPETENT:
        chart = competence_of([not each for each in passed])
        share = chart.scores[-1] / chart.limit if chart.scores else 0.0
        # Rounded down: 100 % is shown only at competence.
        done = min(int(WHOLE_WAY * share), WHOLE_WAY - 1)
        return None if chart.competent_at is None else trials[chart.competent_at - 1], done
    reaching, row = None, 0
    for trial, has_passed in zip(trials, passed, strict=True):
        row = row + 1 if has_passed else 0
        if row == assignment.trials and reaching is None:
            reaching = trial
    return reaching, min(row, assignment.trials)


def _weakest(trials: Sequence[TrialRow]) -> str:
    """Return the part of the score with the least geometric mean, which costs most; "" if none."""
    names = dict.fromkeys(name for trial in trials for name in trial.parts)
    means = {
        name: fmean(math.log(max(trial.parts.get(name, 1.0), 1e-9)) for trial in trials)
        for name in names
    }
    return min(means, key=lambda name: means[name], default="")


def title_of(assignment: Assignment) -> str:
    """Return the title of an assignment, such as "Task 3 by a trace over the skin"."""
    title = trial_title(assignment.task, assignment.mode, assignment.method, assignment.procedure)
    return f"{title} on {assignment.scenario}" if assignment.scenario else title


def progress_of_assignment(standing: AssignmentStanding) -> str:
    """Return the progress of a trainee, such as "1 of 3 trials in a row at 70 or more"."""
    if standing.mark is not None and standing.goal is GoalKind.COMPETENT:
        return f"{standing.done} % of the way to {goal_of(standing)}"
    done = "" if standing.mark is None else f"{standing.done} of "
    return f"{done}{goal_of(standing)}"


def goal_of(standing: AssignmentStanding) -> str:
    """Return the goal, such as "3 trials in a row at 70 or more"."""
    if standing.mark is None:
        return "no pass mark set for its score"
    mark = f"{standing.mark:g} or more"
    if standing.goal is GoalKind.COMPETENT:
        return f"competence (LC-CUSUM), a trial passes at {mark}"
    kind, passed = ("drill", "passed") if standing.task == DECIDE else ("trial", f"at {mark}")
    kinds = kind if standing.needed == 1 else f"{kind}s in a row"
    return f"{standing.needed} {kinds} {passed}"


def short_progress_of(standing: AssignmentStanding) -> str:
    """Return the state for a narrow column: the day (UTC) if reached, the progress if open."""
    if standing.state is not AssignmentState.OPEN:
        return f"{standing.state.value} {day_of(standing.reached_utc)}".rstrip()
    if standing.goal is GoalKind.COMPETENT:
        return f"{standing.done} %"
    return f"{standing.done} of {standing.needed}"


def state_of(standing: AssignmentStanding) -> str:
    if standing.state is not AssignmentState.LOCKED:
        return standing.state.value
    are = "is" if len(standing.missing) == 1 else "are"
    return f"locked until {' and '.join(standing.missing)} {are} reached"


def advice_of(standing: CurriculumStanding) -> str:
    best = standing.next_best
    if best is None:
        return "All assignments are reached."
    task = title_of(best)
    if best.mean is None:
        return f"Next: {task}, which has not been played yet."
    part = wording.PARTS.get(best.weakest, "")
    why = f"; most points are lost on {part}" if part else ""
    return f"Next: {task}, the weakest open one (latest mean {fixed(best.mean, 0)}){why}."
