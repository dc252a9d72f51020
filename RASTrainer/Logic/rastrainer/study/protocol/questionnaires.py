"""Questionnaires: items, allowed answers and scores; the catalog with SUS, raw NASA-TLX and SSQ."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from rastrainer.errors import InputError


@dataclass(frozen=True)
class QuestionnaireItem:
    """One item: a name for data files, and its topic.

    The published wording is its authors'; a lab shows it from its own licensed or printed form. The
    anchors are the meaning of the smallest and the largest answer, if it has its own.
    """

    name: str
    topic: str
    anchors: tuple[str, str] | tuple[()] = ()


@dataclass(frozen=True)
class Scale:
    """A score: name, title, range, and whether more is better (1) or worse (-1)."""

    name: str
    title: str
    lowest: float
    highest: float
    better: int


@dataclass(frozen=True)
class Questionnaire:
    """A questionnaire and its scoring.

    Attributes:
        name: For files and protocols, such as "sus".
        formula: From the checked answers to a score for each scale.
        marks_apart: Distance of the marks in a form; answers between them are valid too.
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
        """The answers offered in a form."""
        return range(self.lowest, self.highest + 1, self.marks_apart)

    def score(self, answers: Sequence[int] | Mapping[str, int]) -> dict[str, float]:
        values = self.formula(self.checked(answers))
        return {scale.name: value for scale, value in zip(self.scales, values, strict=True)}

    def checked(self, answers: Sequence[int] | Mapping[str, int]) -> tuple[int, ...]:
        """Return the answers in the order of the items."""
        names = [item.name for item in self.items]
        if isinstance(answers, Mapping):
            if set(answers) != set(names):
                raise InputError(f"{self.title} needs the answers {', '.join(names)}.")
            answers = [answers[name] for name in names]
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


_SUS_TOPICS = (
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


def _sus_scores(answers: Sequence[int]) -> tuple[float, ...]:
    """Odd items are positive and count answer − 1, even ones negative and count 5 − answer."""
    points = [a - 1 if number % 2 else 5 - a for number, a in enumerate(answers, start=1)]
    return (2.5 * sum(points),)


SUS = Questionnaire(
    name="sus",
    title="SUS",
    items=tuple(
        QuestionnaireItem(f"sus_{i}", topic) for i, topic in enumerate(_SUS_TOPICS, start=1)
    ),
    lowest=1,
    highest=5,
    anchors=("strongly disagree", "strongly agree"),
    scales=(Scale("sus", "SUS", 0.0, 100.0, 1),),
    source="Brooke 1996, SUS: a quick and dirty usability scale",
    formula=_sus_scores,
)


# The six scales have 21 marks, 0 to 100 in steps of 5; the raw score, without the weighting step,
# is their mean. Performance runs from perfect (0) to failure (100), so that on every scale more is
# more workload; none is reversed for the mean.
_TLX_SCALES = (
    ("mental", "Mental demand"),
    ("physical", "Physical demand"),
    ("temporal", "Temporal demand"),
    ("performance", "Performance"),
    ("effort", "Effort"),
    ("frustration", "Frustration"),
)
_TLX_ANCHORS = {"performance": ("perfect", "failure")}
"""Performance does not run from very low to very high."""


def _tlx_scores(answers: Sequence[int]) -> tuple[float, ...]:
    return (sum(answers) / len(answers), *map(float, answers))


def _tlx_title(name: str, title: str) -> str:
    """Return the title of a scale, with its own anchors if it has any."""
    title = f"TLX {title.lower()}"
    if name not in _TLX_ANCHORS:
        return title
    low, high = _TLX_ANCHORS[name]
    return f"{title} (0 is {low}, 100 is {high})"


NASA_TLX = Questionnaire(
    name="nasa-tlx",
    title="NASA-TLX (raw)",
    items=tuple(
        QuestionnaireItem(f"tlx_{name}", title, _TLX_ANCHORS.get(name, ()))
        for name, title in _TLX_SCALES
    ),
    lowest=0,
    highest=100,
    anchors=("very low", "very high"),
    scales=(
        Scale("tlx_raw", "Workload (raw NASA-TLX)", 0.0, 100.0, -1),
        *(
            Scale(f"tlx_{name}", _tlx_title(name, title), 0.0, 100.0, -1)
            for name, title in _TLX_SCALES
        ),
    ),
    source="Hart and Staveland 1988; raw: Hart 2006",
    formula=_tlx_scores,
    marks_apart=5,
)


NAUSEA, OCULOMOTOR, DISORIENTATION = "N", "O", "D"
WEIGHTS = {NAUSEA: 9.54, OCULOMOTOR: 7.58, DISORIENTATION: 13.92}
TOTAL_WEIGHT = 3.74

_SSQ_SYMPTOMS = (
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


def _ssq_scores(answers: Sequence[int]) -> tuple[float, ...]:
    sums = {
        group: sum(
            a for a, (_, _, groups) in zip(answers, _SSQ_SYMPTOMS, strict=True) if group in groups
        )
        for group in WEIGHTS
    }
    parts = (WEIGHTS[group] * total for group, total in sums.items())
    return (TOTAL_WEIGHT * sum(sums.values()), *parts)


SSQ = Questionnaire(
    name="ssq",
    title="SSQ",
    items=tuple(QuestionnaireItem(f"ssq_{name}", title) for name, title, _ in _SSQ_SYMPTOMS),
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
    formula=_ssq_scores,
)


QUESTIONNAIRES = {q.name: q for q in (SUS, NASA_TLX, SSQ)}


def find_questionnaire(name: str) -> Questionnaire:
    """Return a questionnaire; raise `InputError` if unknown."""
    if name not in QUESTIONNAIRES:
        raise InputError(
            f"There is no questionnaire {name[:40]!r}; there are {', '.join(QUESTIONNAIRES)}."
        )
    return QUESTIONNAIRES[name]
