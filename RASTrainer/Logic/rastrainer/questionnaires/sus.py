"""SUS, the System Usability Scale (Brooke 1996)."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.questionnaires.questionnaire import Item, Questionnaire, Scale

_TOPICS = (
    "like to use it often",
    "needlessly complex",
    "easy to use",
    "need a technical person's help",
    "functions well integrated",
    "too much inconsistency",
    "most people learn it quickly",
    "cumbersome",
    "felt confident",
    "had to learn a lot first",
)


def _score(answers: Sequence[int]) -> tuple[float, ...]:
    """Odd items are positive and count answer − 1, even ones negative and count 5 − answer."""
    points = [a - 1 if number % 2 else 5 - a for number, a in enumerate(answers, start=1)]
    return (2.5 * sum(points),)


SUS = Questionnaire(
    name="sus",
    title="SUS",
    items=tuple(Item(f"sus_{i}", topic) for i, topic in enumerate(_TOPICS, start=1)),
    lowest=1,
    highest=5,
    anchors=("strongly disagree", "strongly agree"),
    scales=(Scale("sus", "SUS", 0.0, 100.0, 1),),
    source="Brooke 1996, SUS: a quick and dirty usability scale",
    formula=_score,
)
