"""Where a trainee stands, in English: for the command, the module in Slicer, and the report."""

from __future__ import annotations

from rastrainer.number_text import fixed
from rastrainer.protocol import AssignmentState, GoalKind
from rastrainer.study.curriculum.curriculum import Assignment
from rastrainer.study.curriculum.standing import AssignmentStanding, CurriculumStanding
from rastrainer.study.protocol.steps import trial_title

PARTS = {
    "time": "time",
    "accuracy": "accuracy",
    "common bias": "the bias that all touches share",
    "safety": "unintended contact and pressing",
    "target": "the error at the target",
    "entry": "the error at the entry",
    "angle": "the angle",
    "plunge": "drilling too deep",
    "distance": "the distance to no-go structures",
}
"""Of the scores of touches and of procedures."""

DAY = len("2026-01-31")
"""Of a time as ISO 8601, what its day takes."""


def title_of(assignment: Assignment) -> str:
    """Return what people call an assignment, such as "Task 3 by a trace over the skin"."""
    each = assignment
    head = f" on {each.scenario}" if each.scenario else ""
    return trial_title(each.task, each.mode, each.method, each.procedure) + head


def progress_of_assignment(standing: AssignmentStanding) -> str:
    """Return how far a trainee is, such as "1 of 3 trials in a row at 70 or more"."""
    if standing.mark is not None and standing.assignment.goal is GoalKind.COMPETENT:
        return f"{standing.done} % of the way to {goal_of(standing)}"
    done = "" if standing.mark is None else f"{standing.done} of "
    return f"{done}{goal_of(standing)}"


def goal_of(standing: AssignmentStanding) -> str:
    """Return the goal, such as "3 trials in a row at 70 or more"."""
    if standing.mark is None:
        return "no pass mark set for its score"
    mark = f"{standing.mark:g} or more"
    if standing.assignment.goal is GoalKind.COMPETENT:
        return f"competence (LC-CUSUM), a trial passes at {mark}"
    trials = "trial" if standing.needed == 1 else "trials in a row"
    return f"{standing.needed} {trials} at {mark}"


def short_progress_of(standing: AssignmentStanding) -> str:
    """Return the state for a narrow column: of a reached one the day (UTC), of an open how far."""
    if standing.state is not AssignmentState.OPEN:
        return f"{standing.state.value} {standing.reached_utc[:DAY]}".rstrip()
    if standing.assignment.goal is GoalKind.COMPETENT:
        return f"{standing.done} %"
    return f"{standing.done} of {standing.needed}"


def state_of(standing: AssignmentStanding) -> str:
    """Return the state, and what a locked assignment waits for, by name."""
    if standing.state is not AssignmentState.LOCKED:
        return standing.state.value
    return f"locked until {' and '.join(standing.missing)} {_are(standing.missing)} reached"


def advice_of(standing: CurriculumStanding) -> str:
    """Return the sentence about what to practice next, and why."""
    best = standing.next_best
    if best is None:
        return "All assignments are reached."
    task = title_of(best.assignment)
    if best.mean is None:
        return f"Next: {task}, which has not been played yet."
    part = PARTS.get(best.weakest, "")
    why = f"; most points are lost on {part}" if part else ""
    return f"Next: {task}, the weakest open one (latest mean {fixed(best.mean, 0)}){why}."


def _are(names: tuple[str, ...]) -> str:
    return "is" if len(names) == 1 else "are"
