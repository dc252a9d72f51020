"""How well the raters of replays agree, and whether their marks match the computed score."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from rastrainer.errors import InputError
from rastrainer.number_text import counted, fixed
from rastrainer.report import page
from rastrainer.statistics.agreement import (
    FEWEST,
    Agreement,
    IntraclassCorrelations,
    intraclass_correlations,
    quadratic_kappa,
)
from rastrainer.statistics.intervals import correlation, scipy_module
from rastrainer.study.ratings import FORMS, HIGHEST, LOWEST, Rating, RatingForm
from rastrainer.study.study_data import StudyData

_WORDS = ((0.5, "poor"), (0.75, "moderate"), (0.9, "good"), (float("inf"), "excellent"))
"""Below which ICC reliability is called so (Koo and Li 2016)."""
TOTALS: page.Line = ["Form", "n", "Raters", "ICC(2,1) [95 %]", "ICC(2,k) [95 %]", "Mean totals"]
DOMAINS: page.Line = ["Domain", "n", "Raters", "κ [95 %]", "Same mark", "Mean marks"]
SCORES: page.Line = ["Rating", "n", "Pearson r [95 %]", "Spearman ρ"]

Marks = Mapping[str, Mapping[str, Rating]]
"""Ratings on one form: rater → trial → rating."""


def raters(data: StudyData) -> str:
    """Return the section; "" if nobody has rated replays."""
    parts = [_of_form(form, marks, data) for form in FORMS.values() if (marks := _of(data, form))]
    if not parts:
        return ""
    return page.section(
        "Raters", page.paragraph(_INTRODUCTION), *parts, page.paragraph(_NOTE, "small")
    )


_INTRODUCTION = (
    "Raters saw replays under shuffled numbers, without trainee, date, score or mode, and marked "
    f"each domain from {LOWEST} to {HIGHEST}. The forms leave out what a replay cannot show; their "
    "totals are not those of the whole published forms."
)
_NOTE = (
    "ICC: two-way random effects, absolute agreement, of a single rater and of the mean of all "
    "(Shrout and Fleiss 1979; limits: generalized, Weerahandi 1993; two raters say little about "
    "others, so that three or more narrow them most). κ: quadratic weights (Cohen 1968; limits by "
    "the jackknife on Fisher's z). Words: below 0.5 poor, to 0.75 moderate, to 0.9 good, "
    "above excellent (Koo and Li 2016). All take replays as independent, which those of one "
    "trainee are not quite."
)


def _of(data: StudyData, form: RatingForm) -> Marks:
    found: dict[str, dict[str, Rating]] = {}
    for rating in data.ratings:
        if rating.form == form.name:
            found.setdefault(rating.rater, {})[rating.trial_id] = rating
    return found


def _of_form(form: RatingForm, marks: Marks, data: StudyData) -> str:
    names = sorted(marks)
    shared = sorted(set.intersection(*(set(of_rater) for of_rater in marks.values())))
    left_out = "; ".join(f"{title.lower()} ({why})" for title, why in form.left_out.items())
    range_ = f"{form.lowest_total} to {form.highest_total}"
    scope = f"Totals of {counted(len(form.domains), 'domain')}, {range_}. Left out: {left_out}."
    parts = [page.heading(form.title), page.paragraph(scope)]
    if len(names) < 2 or len(shared) < FEWEST:
        replays = counted(len(shared), "replay")
        few = (
            f"{' and '.join(names)} {'have' if len(names) > 1 else 'has'} rated {replays}"
            f"{' in common' if len(names) > 1 else ''}: agreement needs two raters and {FEWEST} "
            "replays that both have rated."
        )
        parts.append(page.paragraph(few, "warning"))
    else:
        parts += _agreement(form, marks, names, shared)
    return "".join([*parts, *_compared_with_score(form, marks, data)])


def _agreement(
    form: RatingForm, marks: Marks, names: Sequence[str], shared: Sequence[str]
) -> list[str]:
    totals = np.array([[marks[name][trial].total for name in names] for trial in shared], float)
    means = " / ".join(fixed(float(mean), 1) for mean in totals.mean(axis=0))
    who = ", ".join(names)
    try:
        found = intraclass_correlations(totals)
    except InputError as error:
        line: page.Line = [form.title, str(len(shared)), who, "–", "–", means]
        said = [page.paragraph(str(error), "warning")]
    else:
        values = (agreement_text(found.single), agreement_text(found.average))
        line = [form.title, str(len(shared)), who, *values, means]
        said = [page.paragraph(_meaning(found))]
    rows = [
        _domain(domain.title, domain.name, marks, pair, shared)
        for domain in form.domains
        for pair in itertools.combinations(names, 2)
    ]
    return [*said, page.table([TOTALS], [line]), page.table([DOMAINS], rows)]


def _domain(
    title: str, domain: str, marks: Marks, pair: tuple[str, str], shared: Sequence[str]
) -> page.Line:
    first, second = (
        np.array([marks[name][trial].marks[domain] for trial in shared]) for name in pair
    )
    try:
        kappa = agreement_text(quadratic_kappa(first, second, LOWEST, HIGHEST))
    except InputError:
        kappa = "–"
    same = f"{fixed(100.0 * float(np.mean(first == second)), 0)} %"
    means = f"{fixed(float(first.mean()), 1)} / {fixed(float(second.mean()), 1)}"
    return [title, str(len(shared)), ", ".join(pair), kappa, same, means]


def _meaning(found: IntraclassCorrelations) -> str:
    of_mean = f"the mean of {counted(found.raters, 'rater')}"
    return (
        f"Of {counted(found.objects, 'replay')}, the total of a single rater is "
        f"{_in_words(found.single)}, {of_mean} is {_in_words(found.average)}. Where the mean is "
        "good, it may stand for the quality of a trial; a single rater's total needs an ICC(2,1) "
        "that is good itself."
    )


def _in_words(agreement: Agreement) -> str:
    word = _word(agreement.value)
    if agreement.interval is None:
        return f"{word} as a measure (the raters differ by a constant: no interval)"
    low, high = map(_word, agreement.interval)
    ends = "by its whole interval" if low == high else f"by its interval {low} to {high}"
    return f"{word} as a measure ({ends})"


def _word(value: float) -> str:
    return next(word for limit, word in _WORDS if value < limit)


def agreement_text(agreement: Agreement) -> str:
    """Return a coefficient with its interval, such as `0.85 [0.62, 0.94]`."""
    value = fixed(agreement.value, 2)
    if agreement.interval is None:
        return f"{value} [–]"
    low, high = (fixed(max(-1.0, limit), 2) for limit in agreement.interval)
    return f"{value} [{low}, {high}]"


def _compared_with_score(form: RatingForm, marks: Marks, data: StudyData) -> list[str]:
    """Return how the mean total of the raters relates to the computed score of the same trials."""
    scores = {
        trial.trial_id: trial.values["score"] for trial in data.trials if "score" in trial.values
    }
    everyone = set.intersection(*(set(of_rater) for of_rater in marks.values()))
    rated = sorted(everyone & scores.keys())
    totals = np.array([np.mean([of[trial].total for of in marks.values()]) for trial in rated])
    computed = np.array([scores[trial] for trial in rated])
    try:
        found = correlation(totals, computed)
    except InputError:
        text = (
            f"Whether the score goes with the {form.title} marks cannot be seen from "
            f"{counted(len(rated), 'scored replay')}: three are needed, and both must vary."
        )
        return [page.paragraph(text)]
    rank = float(scipy_module("stats").spearmanr(totals, computed).statistic)
    value = agreement_text(Agreement(found.r, found.interval))
    limits = found.interval
    is_shown = limits is not None and limits[0] * limits[1] > 0.0
    way = "higher" if found.r > 0 else "lower"
    text = (
        f"Trials with higher marks have {way} computed scores (r = {fixed(found.r, 2)}, "
        f"n = {found.n})."
        if is_shown
        else f"A connection of marks and computed score is not shown (r = {fixed(found.r, 2)}, "
        f"n = {found.n}); few replays show only a strong one."
    )
    line: page.Line = [f"{form.title}, mean of raters, with the score", str(found.n), value]
    return [page.paragraph(text), page.table([SCORES], [[*line, fixed(rank, 2)]])]
