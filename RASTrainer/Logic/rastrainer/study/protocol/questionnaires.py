"""Questionnaires: items, allowed answers and scores; SUS, raw NASA-TLX and SSQ.

Their items and scales are in `questionnaires.json`, by their topics: the published wording is its
authors', and a lab shows it from its own licensed or printed form.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from rastrainer.errors import InputError
from rastrainer.json_checks import number, texts, whole_number
from rastrainer.json_records import record_from_json

_Mark = Annotated[int, whole_number(0, 100)]


@dataclass(frozen=True)
class QuestionnaireItem:
    """One item: a name for data files, and its topic.

    It may have its own anchors, the meaning of the smallest and the largest answer. `groups` are
    the first letters of the SSQ's scales that include the symptom.
    """

    name: str
    topic: str
    anchors: Annotated[tuple[str, ...], texts(2, 2)] = ()
    groups: str = ""


@dataclass(frozen=True)
class Scale:
    """A score from `lowest` to `highest`, where more is better (1) or worse (-1)."""

    name: str
    title: str
    highest: Annotated[float, number(0, 1000)]
    better: Annotated[int, whole_number(-1, 1)]
    lowest: Annotated[float, number(0, 0)] = 0.0


@dataclass(frozen=True)
class Questionnaire:
    """A questionnaire; answers between the marks of its form are valid, too."""

    name: str
    title: str
    source: str
    lowest: _Mark
    highest: _Mark
    anchors: Annotated[tuple[str, ...], texts(2, 2)]
    items: tuple[QuestionnaireItem, ...]
    scales: tuple[Scale, ...]
    marks_apart: _Mark = 1

    @property
    def marks(self) -> range:
        return range(self.lowest, self.highest + 1, self.marks_apart)

    def score(self, answers: Sequence[int]) -> dict[str, float]:
        values = _SCORES[self.name](self.checked(answers))
        return {scale.name: value for scale, value in zip(self.scales, values, strict=True)}

    def checked(self, answers: Sequence[int]) -> tuple[int, ...]:
        names = [item.name for item in self.items]
        if isinstance(answers, str) or len(answers) != len(names):
            raise InputError(f"{self.title} needs {len(names)} answers, one for each item.")
        for name, answer in zip(names, answers, strict=True):
            is_whole = isinstance(answer, int) and not isinstance(answer, bool)
            if not (is_whole and self.lowest <= answer <= self.highest):
                raise InputError(
                    f"{self.title}: the answer {name} must be a whole number from {self.lowest} "
                    f"to {self.highest}; leave none out."
                )
        return tuple(answers)


def _sus_scores(answers: Sequence[int]) -> tuple[float, ...]:
    """Odd items are positive and count answer − 1, even items negative and count 5 − answer."""
    points = [a - 1 if number % 2 else 5 - a for number, a in enumerate(answers, start=1)]
    return (2.5 * sum(points),)


def _tlx_scores(answers: Sequence[int]) -> tuple[float, ...]:
    """Return the raw score, the mean without the weighting step, and each answer.

    Performance runs from perfect (0) to failure (100), so that on every scale more is more
    workload; none is reversed for the mean.
    """
    return (sum(answers) / len(answers), *map(float, answers))


WEIGHTS = {"N": 9.54, "O": 7.58, "D": 13.92}
"""The weights of nausea, oculomotor symptoms and disorientation."""
TOTAL_WEIGHT = 3.74


def _ssq_scores(answers: Sequence[int]) -> tuple[float, ...]:
    given = list(zip(answers, SSQ.items, strict=True))
    sums = {group: sum(a for a, item in given if group in item.groups) for group in WEIGHTS}
    parts = (WEIGHTS[group] * total for group, total in sums.items())
    return (TOTAL_WEIGHT * sum(sums.values()), *parts)


_SCORES = {"sus": _sus_scores, "nasa-tlx": _tlx_scores, "ssq": _ssq_scores}
"""Formulas: they map the checked answers to a score for each scale."""
_FILE = Path(__file__).with_name("questionnaires.json").read_text(encoding="utf-8")
SUS, NASA_TLX, SSQ = (record_from_json(Questionnaire, each) for each in json.loads(_FILE))
QUESTIONNAIRES = {q.name: q for q in (SUS, NASA_TLX, SSQ)}


def find_questionnaire(name: str) -> Questionnaire:
    if name not in QUESTIONNAIRES:
        raise InputError(
            f"There is no questionnaire {name[:40]!r}; there are {', '.join(QUESTIONNAIRES)}."
        )
    return QUESTIONNAIRES[name]
