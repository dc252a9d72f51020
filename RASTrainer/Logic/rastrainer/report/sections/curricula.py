"""Where trainees stand in their curricula: each assignment, reached or how far."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer.report.elements.markup import bullets, heading, paragraph, section, table
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import AssignmentStanding, CurriculumStanding
from rastrainer.study.curriculum.wording import goal_of, short_progress_of, title_of
from rastrainer.study.study_data import StudyData

_NOTE = (
    "Trials in a row that pass are a goal for practice, not a proof of competence: a trainee who "
    "plays long enough reaches them by chance. Aborted trials with a touch count as not passed, "
    "and n counts them."
)


def curricula(data: StudyData) -> str:
    """Return the section; "" if nobody follows a curriculum."""
    groups: dict[Curriculum, dict[str, CurriculumStanding]] = {}
    for name, standing in data.standings.items():
        groups.setdefault(standing.curriculum, {})[name] = standing
    if not groups:
        return ""
    parts = [_of_curriculum(each, found) for each, found in groups.items()]
    return section("Curriculum", *parts, paragraph(_NOTE, "small"))


def _of_curriculum(curriculum: Curriculum, found: Mapping[str, CurriculumStanding]) -> str:
    first = next(iter(found.values()))
    header = ["trainee", "trials (n)", "reached", *(each.name for each in curriculum.assignments)]
    rows = [
        [
            name,
            str(standing.played),
            f"{standing.reached} of {len(standing.standings)}",
            *map(short_progress_of, standing.standings),
        ]
        for name, standing in found.items()
    ]
    goals = [f"{each.assignment.name}: {_goal(each)}" for each in first.standings]
    return heading(curriculum.title) + table([header], rows) + bullets(goals)


def _goal(standing: AssignmentStanding) -> str:
    after = ", ".join(standing.assignment.after)
    gate = f"; after {after}" if after else ""
    return f"{title_of(standing.assignment)}, {goal_of(standing)}{gate}"
