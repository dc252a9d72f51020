"""Answers to a questionnaire, as the simulator tells them to Slicer (`StepAnswered`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rastrainer.checked_json import Fields
from rastrainer.experiment.study_step import StudyStep
from rastrainer.questionnaires.catalog import find_questionnaire

MOST_STEPS = 100_000


@dataclass(frozen=True)
class StepAnswers:
    """The answers, and the step that asked for them.

    Attributes:
        trainee: Pseudonym.
        number: Of the step, from 1.
        questionnaire: Its name.
        answers: One for each item, in their order.
    """

    trainee: str
    number: int
    questionnaire: str
    answers: tuple[int, ...]

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> StepAnswers:
        """Return the answers that a JSON object holds.

        Raises:
            InputError: it does not hold one allowed answer for each item of a questionnaire.
        """
        fields = Fields(dict(value), Path("StepAnswered"))
        questionnaire = find_questionnaire(fields.text("questionnaire", 40))
        answers = value.get("answers")
        if not isinstance(answers, list):
            raise fields.error("answers", "a list of whole numbers")
        return cls(
            fields.text("trainee", 64),
            fields.whole_number("number", 1, MOST_STEPS),
            questionnaire.name,
            questionnaire.checked(answers),
        )

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `from_json` reads."""
        return asdict(self) | {"answers": list(self.answers)}

    def belong_to(self, step: StudyStep) -> bool:
        """Return whether this is the step that they answer."""
        answered = (self.trainee, self.number, self.questionnaire)
        return answered == (step.trainee, step.number, step.questionnaire)
