"""How well the raters of replays agree, and whether their marks match the computed score."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy
from markupsafe import Markup

from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.study.ratings import FORMS, HIGHEST, LOWEST, Rating, RatingForm
from rastrainer.study.study_data import StudyData
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.agreement import (
    FEWEST,
    Agreement,
    intraclass_correlations,
    quadratic_kappa,
)
from rastrainer_simulator.statistics.intervals import correlation

_WORDS = ((0.5, "poor"), (0.75, "moderate"), (0.9, "good"), (float("inf"), "excellent"))
"""Names of reliability, each with the ICC below which it holds (Koo and Li 2016)."""
Marks = Mapping[str, Mapping[str, Rating]]
"""Ratings on one form: rater → trial → rating."""


def raters(data: StudyData) -> Markup:
    """Return the section; "" if nobody has rated replays."""
    marks: dict[str, dict[str, dict[str, Rating]]] = defaultdict(lambda: defaultdict(dict))
    for rating in data.ratings:
        marks[rating.form][rating.rater][rating.trial_id] = rating
    forms = [_of_form(form, marks[name], data) for name, form in FORMS.items() if name in marks]
    if not forms:
        return Markup()
    return render(
        "raters",
        forms=forms,
        lowest=LOWEST,
        highest=HIGHEST,
        fewest=FEWEST,
        in_words=_in_words,
        agreement_text=agreement_text,
    )


def _of_form(form: RatingForm, marks: Marks, data: StudyData) -> dict[str, Any]:
    names = sorted(marks)
    shared = sorted(set.intersection(*(set(of_rater) for of_rater in marks.values())))
    found: dict[str, Any] = {"form": form, "raters": names, "shared": len(shared)}
    if len(names) >= 2 and len(shared) >= FEWEST:
        totals = [[marks[name][trial].total for name in names] for trial in shared]
        found["means"] = [fixed(float(mean), 1) for mean in np.mean(totals, axis=0)]
        try:
            found["icc"], found["problem"] = intraclass_correlations(np.array(totals)), ""
        except InputError as error:
            found["icc"], found["problem"] = None, str(error)
        found["domains"] = []
        for domain, pair in itertools.product(form.domains, itertools.combinations(names, 2)):
            first, second = (
                np.array([marks[name][trial].marks[domain.name] for trial in shared])
                for name in pair
            )
            try:
                kappa = agreement_text(quadratic_kappa(first, second, LOWEST, HIGHEST))
            except InputError:
                kappa = "–"
            same = f"{fixed(100.0 * float(np.mean(first == second)), 0)} %"
            means = f"{fixed(float(first.mean()), 1)} / {fixed(float(second.mean()), 1)}"
            row = [domain.title, str(len(shared)), ", ".join(pair), kappa, same, means]
            found["domains"].append(row)
    scores = {
        trial.trial_id: trial.values["score"] for trial in data.trials if "score" in trial.values
    }
    rated = [trial for trial in shared if trial in scores]
    total = np.array([np.mean([of[trial].total for of in marks.values()]) for trial in rated])
    computed = np.array([scores[trial] for trial in rated])
    try:
        found["correlation"] = correlation(total, computed)
    except InputError:
        return {**found, "scored": len(rated), "correlation": None}
    return {**found, "rank": float(scipy.stats.spearmanr(total, computed).statistic)}


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
    value = fixed(agreement.value, 2)
    if agreement.interval is None:
        return f"{value} [–]"
    low, high = (fixed(max(-1.0, limit), 2) for limit in agreement.interval)
    return f"{value} [{low}, {high}]"
