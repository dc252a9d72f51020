"""Raw NASA-TLX: perceived workload without the weighting step (Hart and Staveland 1988; Hart 2006).

The six scales have 21 marks, 0 to 100 in steps of 5; the raw score is their mean.
"""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.questionnaires.questionnaire import Item, Questionnaire, Scale

_SCALES = (
    ("mental", "Mental demand"),
    ("physical", "Physical demand"),
    ("temporal", "Temporal demand"),
    ("performance", "Performance (0 is perfect, 100 is failure)"),
    ("effort", "Effort"),
    ("frustration", "Frustration"),
)


def _score(answers: Sequence[int]) -> tuple[float, ...]:
    return (sum(answers) / len(answers), *map(float, answers))


NASA_TLX = Questionnaire(
    name="nasa-tlx",
    title="NASA-TLX (raw)",
    items=tuple(Item(f"tlx_{name}", title) for name, title in _SCALES),
    lowest=0,
    highest=100,
    anchors=("very low", "very high"),
    scales=(
        Scale("tlx_raw", "Workload (raw NASA-TLX)", 0.0, 100.0, -1),
        *(Scale(f"tlx_{name}", title, 0.0, 100.0, -1) for name, title in _SCALES),
    ),
    source="Hart and Staveland 1988; raw: Hart 2006",
    formula=_score,
    marks_apart=5,
)
