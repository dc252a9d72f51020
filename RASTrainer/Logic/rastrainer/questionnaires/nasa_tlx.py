"""Raw NASA-TLX: perceived workload without the weighting step (Hart and Staveland 1988; Hart 2006).

The six scales have 21 marks, 0 to 100 in steps of 5; the raw score is their mean. Performance runs
from perfect (0) to failure (100), so that on every scale more is more workload; none is turned
around for the mean.
"""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.questionnaires.questionnaire import Item, Questionnaire, Scale

_SCALES = (
    ("mental", "Mental demand"),
    ("physical", "Physical demand"),
    ("temporal", "Temporal demand"),
    ("performance", "Performance"),
    ("effort", "Effort"),
    ("frustration", "Frustration"),
)
_ANCHORS = {"performance": ("perfect", "failure")}
"""Of the scale that does not run from very low to very high."""


def _score(answers: Sequence[int]) -> tuple[float, ...]:
    return (sum(answers) / len(answers), *map(float, answers))


def _titled(name: str, title: str) -> str:
    """Return the title of a scale beside those of others, with its ends where they are its own."""
    title = f"TLX {title.lower()}"
    if name not in _ANCHORS:
        return title
    low, high = _ANCHORS[name]
    return f"{title} (0 is {low}, 100 is {high})"


NASA_TLX = Questionnaire(
    name="nasa-tlx",
    title="NASA-TLX (raw)",
    items=tuple(Item(f"tlx_{name}", title, _ANCHORS.get(name, ())) for name, title in _SCALES),
    lowest=0,
    highest=100,
    anchors=("very low", "very high"),
    scales=(
        Scale("tlx_raw", "Workload (raw NASA-TLX)", 0.0, 100.0, -1),
        *(Scale(f"tlx_{name}", _titled(name, title), 0.0, 100.0, -1) for name, title in _SCALES),
    ),
    source="Hart and Staveland 1988; raw: Hart 2006",
    formula=_score,
    marks_apart=5,
)
