"""A questionnaire: its items, which answers they take, and how these become scores."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rastrainer.errors import InputError


@dataclass(frozen=True)
class QuestionnaireItem:
    """One item: a name for data files, and what it is about.

    The published wording is its authors'; a lab shows it from its own licensed or printed form.

    Attributes:
        name: For data files.
        topic: What it is about.
        anchors: What the smallest and the largest answer mean, where that differs from what they
            mean for the questionnaire's other items; empty otherwise.
    """

    name: str
    topic: str
    anchors: tuple[str, str] | tuple[()] = ()


@dataclass(frozen=True)
class Scale:
    """One score: its name, title, range, and whether more is better (1) or worse (-1)."""

    name: str
    title: str
    lowest: float
    highest: float
    better: int


@dataclass(frozen=True)
class Questionnaire:
    """What is asked and how it is scored.

    Attributes:
        name: For files and protocols, such as "sus".
        title: For people.
        items: In the order in which they are asked.
        lowest: Smallest answer.
        highest: Largest answer.
        anchors: What the smallest and the largest mean, but for items with anchors of their own.
        scales: What the answers are scored on.
        source: Who published items and scoring.
        formula: From the checked answers to a score for each scale.
        marks_apart: Distance of the marks that a form offers; the answers between them count, too.
    """

    name: str
    title: str
    items: tuple[QuestionnaireItem, ...]
    lowest: int
    highest: int
    anchors: tuple[str, str]
    scales: tuple[Scale, ...]
    source: str
    formula: Callable[[Sequence[int]], tuple[float, ...]]
    marks_apart: int = 1

    @property
    def marks(self) -> range:
        """The answers that a form offers."""
        return range(self.lowest, self.highest + 1, self.marks_apart)

    def score(self, answers: Sequence[int] | Mapping[str, int]) -> dict[str, float]:
        """Return the score on each scale.

        Args:
            answers: One whole number for each item, in their order or by their names.

        Raises:
            InputError: an answer is missing, is too many or out of range; nothing is filled in.
        """
        values = self.formula(self.checked(answers))
        return {scale.name: value for scale, value in zip(self.scales, values, strict=True)}

    def checked(self, answers: Sequence[int] | Mapping[str, int]) -> tuple[int, ...]:
        """Return the answers in the order of the items.

        Raises:
            InputError: as `score`.
        """
        names = [item.name for item in self.items]
        if isinstance(answers, Mapping):
            if set(answers) != set(names):
                raise InputError(f"{self.title} needs the answers {', '.join(names)}.")
            answers = [answers[name] for name in names]
        if isinstance(answers, str) or len(answers) != len(names):
            raise InputError(f"{self.title} needs {len(names)} answers, one for each item.")
        for name, answer in zip(names, answers, strict=True):
            if not self._is_answer(answer):
                raise InputError(
                    f"{self.title}: the answer {name} must be a whole number from {self.lowest} "
                    f"to {self.highest}; leave none out."
                )
        return tuple(answers)

    def _is_answer(self, value: Any) -> bool:
        is_whole = isinstance(value, int) and not isinstance(value, bool)
        return is_whole and self.lowest <= value <= self.highest
