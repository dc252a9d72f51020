"""SSQ, the Simulator Sickness Questionnaire (Kennedy, Lane, Berbaum and Lilienthal 1993)."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.questionnaires.questionnaire import Item, Questionnaire, Scale

NAUSEA, OCULOMOTOR, DISORIENTATION = "N", "O", "D"
WEIGHTS = {NAUSEA: 9.54, OCULOMOTOR: 7.58, DISORIENTATION: 13.92}
TOTAL_WEIGHT = 3.74

_SYMPTOMS = (
    ("discomfort", "General discomfort", "NO"),
    ("fatigue", "Fatigue", "O"),
    ("headache", "Headache", "O"),
    ("eyestrain", "Eyestrain", "O"),
    ("focusing", "Difficulty focusing", "OD"),
    ("salivation", "Increased salivation", "N"),
    ("sweating", "Sweating", "N"),
    ("nausea", "Nausea", "ND"),
    ("concentrating", "Difficulty concentrating", "NO"),
    ("fullness", "Fullness of head", "D"),
    ("blurred", "Blurred vision", "OD"),
    ("dizzy_open", "Dizzy, eyes open", "D"),
    ("dizzy_closed", "Dizzy, eyes closed", "D"),
    ("vertigo", "Vertigo", "D"),
    ("stomach", "Stomach awareness", "N"),
    ("burping", "Burping", "N"),
)


def _score(answers: Sequence[int]) -> tuple[float, ...]:
    sums = {
        group: sum(
            a for a, (_, _, groups) in zip(answers, _SYMPTOMS, strict=True) if group in groups
        )
        for group in WEIGHTS
    }
    parts = (WEIGHTS[group] * total for group, total in sums.items())
    return (TOTAL_WEIGHT * sum(sums.values()), *parts)


SSQ = Questionnaire(
    name="ssq",
    title="SSQ",
    items=tuple(Item(f"ssq_{name}", title) for name, title, _ in _SYMPTOMS),
    lowest=0,
    highest=3,
    anchors=("none", "severe"),
    scales=(
        Scale("ssq_total", "Simulator sickness (SSQ)", 0.0, 63 * TOTAL_WEIGHT, -1),
        Scale("ssq_nausea", "SSQ nausea", 0.0, 21 * WEIGHTS[NAUSEA], -1),
        Scale("ssq_oculomotor", "SSQ oculomotor", 0.0, 21 * WEIGHTS[OCULOMOTOR], -1),
        Scale("ssq_disorientation", "SSQ disorientation", 0.0, 21 * WEIGHTS[DISORIENTATION], -1),
    ),
    source="Kennedy, Lane, Berbaum and Lilienthal 1993",
    formula=_score,
)
