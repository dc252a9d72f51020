"""The table of a class as the board's page gets it, in the words that trainees read."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import (
    AssignmentStanding,
    CurriculumStanding,
    by_curriculum,
)
from rastrainer.study.curriculum.told_curriculum import ToldAssignment
from rastrainer_simulator.board.class_reader import ClassStanding
from rastrainer_simulator.flow.session.curricula import AssignmentWords
from rastrainer_simulator.ops.texts.texts import LANGUAGES, Texts


def class_table(found: ClassStanding, language: str) -> list[dict[str, Any]]:
    """Return a table for each curriculum, ready for JSON; docs/views.md says what each member is.

    Args:
        found: Where everybody stands.
        language: Tag of `LANGUAGES`.
    """
    texts = Texts(LANGUAGES[language])

    def task_title(name: str) -> str:
        key = f"task.{name}"
        return texts.say(key) if key in texts else _spoken(name)

    words = AssignmentWords(texts, task_title, _spoken)
    groups = by_curriculum(found.standings)
    return [_table(curriculum, group, words) for curriculum, group in groups.items()]


def _table(
    curriculum: Curriculum, group: Mapping[str, CurriculumStanding], words: AssignmentWords
) -> dict[str, Any]:
    first = next(iter(group.values()))
    return {
        "title": curriculum.title,
        "assignments": [_column(each, words) for each in first.standings],
        "trainees": [_row(name, standing, words) for name, standing in group.items()],
    }


def _column(standing: AssignmentStanding, words: AssignmentWords) -> dict[str, Any]:
    told = ToldAssignment.of(standing)
    return {"name": told.name, "label": words.label(told), "goal": words.goal(told)}


def _row(name: str, standing: CurriculumStanding, words: AssignmentWords) -> dict[str, Any]:
    best = standing.next_best
    return {
        "trainee": name,
        "reached": standing.reached,
        "next": "" if best is None else words.label(ToldAssignment.of(best)),
        "cells": [_cell(each, words) for each in standing.standings],
    }


def _cell(standing: AssignmentStanding, words: AssignmentWords) -> dict[str, Any]:
    return {
        "state": standing.state.value,
        "progress": words.progress(ToldAssignment.of(standing)),
        "done": standing.done,
        "needed": standing.needed,
        "reachedUtc": standing.reached_utc,
    }


def _spoken(name: str) -> str:
    """Return the name of a task or procedure as people write it."""
    return name.replace("-", " ").capitalize()
