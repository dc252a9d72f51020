"""The report shows how far raters agree, and whether marks go with the computed score."""

import re
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.study.ratings import FORMS, GEARS, OSATS, Rating
from rastrainer_simulator.report.raters import raters
from rastrainer_simulator.report.report import report_html
from rastrainer_simulator.statistics.agreement import intraclass_correlations, quadratic_kappa
from Testing.simulator.report.test_report import cohort, words_of

pytestmark = pytest.mark.usefixtures("undrawn")


def rated(trainees=4, names=("R1", "R2"), forms=(GEARS, OSATS), noise=0.6, seed=3):
    """Return a study whose trials have UUIDs, and marks that go with a scored quality."""
    random = np.random.default_rng(seed)
    data = cohort(trainees)
    trials, ratings = [], []
    for number, trial in enumerate(data.trials):
        quality = random.normal(3.0, 1.0)
        trial_id = f"00000000-0000-0000-0000-{number:012d}"
        values = {**trial.values, "score": 50.0 + 12.0 * (quality - 3.0)}
        trials.append(replace(trial, trial_id=trial_id, values=values))
        for form in forms:
            for name in names:
                drawn = np.rint(quality + random.normal(0.0, noise, len(form.domains)))
                marks = np.clip(drawn, 1, 5).astype(int).tolist()
                named = dict(zip((d.name for d in form.domains), marks, strict=True))
                ratings.append(Rating(name, trial_id, form.name, named))
    return replace(data, trials=tuple(trials), ratings=tuple(ratings))


def of_rater(data, name, form):
    found = [r for r in data.ratings if (r.rater, r.form) == (name, form.name)]
    return sorted(found, key=lambda rating: rating.trial_id)


@pytest.fixture(scope="module")
def data():
    return rated()


@pytest.fixture(scope="module")
def words(data):
    return words_of(raters(data))


def shown(agreement):
    low, high = agreement.interval
    return f"{agreement.value:.2f} [{low:.2f}, {high:.2f}]"


@pytest.mark.parametrize("form", FORMS.values(), ids=lambda form: form.name)
def test_totals_have_both_coefficients_and_each_domain_a_kappa_with_intervals(data, words, form):
    first, second = (of_rater(data, name, form) for name in ("R1", "R2"))
    totals = np.array([[a.total, b.total] for a, b in zip(first, second, strict=True)])
    found = intraclass_correlations(totals)
    assert f"{form.title} 24 R1, R2 {shown(found.single)} {shown(found.average)}" in words
    for domain in form.domains:
        marks = ([rating.marks[domain.name] for rating in rater] for rater in (first, second))
        kappa = quadratic_kappa(*marks, 1, 5)
        assert f"{domain.title} 24 R1, R2 {shown(kappa)}" in words


def test_the_meaning_is_explained_in_words_with_n(words):
    assert re.search(r"Of 24 replays, the total of a single rater is (good|excellent)", words)
    assert "the mean of 2 raters is excellent as a measure" in words
    assert re.search(r"Trials with higher marks have higher computed scores \(r = 0\.9\d", words)
    assert re.search(
        r"GEARS, mean of raters, with the score 24 0\.9\d \[0\.\d\d, 0\.\d\d\] 0", words
    )


def test_a_single_rater_or_two_replays_are_reported_as_too_few_for_agreement():
    words = words_of(raters(rated(names=("R1",))))
    assert "R1 has rated 24 replays: agreement needs two raters and 3 replays" in words
    data = rated()
    few = {trial.trial_id for trial in data.trials[:2]}
    ratings = tuple(r for r in data.ratings if r.rater == "R1" or r.trial_id in few)
    words = words_of(raters(replace(data, ratings=ratings)))
    assert "R1 and R2 have rated 2 replays in common" in words
    assert "cannot be seen from 2 scored replays" in words


def test_a_study_without_ratings_has_no_such_section(data):
    assert raters(cohort(2)) == ""
    assert "<h2>Raters</h2>" in report_html(data, "today")
