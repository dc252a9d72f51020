"""The report tells what decisions cost and miss, whether they get better, and how sure that is."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm, page_trend_test, t, ttest_rel

from rastrainer.decision.drill_record import Decision, Fault
from rastrainer.json_records import record_from_json
from rastrainer.study.tidy_csv import cases_csv
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.report.decisions import COST, SENSITIVITY, decisions, decisions_of
from rastrainer_simulator.report.report import report_html, write_report
from Testing.domain.trial.trial_records import make_aborted
from Testing.drawn_drills import draw_drills
from Testing.simulator.report.test_report import cohort, words_of
from Testing.simulator.report.without_charts import without_charts

BLIND_SPOT = {Fault.SHIFTED_SKIN: 1.5}


def studied(trainees=8, sensitivities=(1.0, 1.4, 1.6, 1.8, 1.9), seed=5, **model):
    """Return a study with drills on five days, and with trials on the third."""
    drills = draw_drills(np.random.default_rng(seed), trainees, sensitivities, **model)
    data = cohort(trainees, tasks=1)
    trials = (replace(trial, started_utc="2026-05-03T09:00:00Z") for trial in data.trials)
    return replace(data, trials=tuple(trials), drills=drills)


@pytest.fixture(scope="module")
def data():
    return studied(blind_spots=BLIND_SPOT, overconfidence=2.0)


@pytest.fixture(scope="module")
def words(data):
    with without_charts():
        return words_of(decisions(decisions_of(data)))


@pytest.fixture(scope="module")
def page(data):
    with without_charts():
        return words_of(report_html(data, "today"))


def table_of(data):
    """Return the decided cases as arrays by name, and the trainee and drill of each."""
    cases = [(drill, case) for drill in data.drills for case in drill.cases]
    return {
        "trainee": np.array([drill.trainee for drill, _ in cases]),
        "day": np.array([int(drill.started_utc[8:10]) for drill, _ in cases]),
        "over": np.array([case.true_error_mm > case.limit_mm for _, case in cases]),
        "refused": np.array([case.decision != Decision.PROCEED for _, case in cases]),
        "fault": np.array([case.fault.value for _, case in cases]),
    }


def d_prime(over, refused):
    """Return d′ of log-linear rates, and its interval by the recovery of both rates' intervals."""
    counts = [(own.sum(), len(own)) for own in (refused[over], refused[~over])]
    hit, alarm = (norm.ppf((count + 0.5) / (total + 1)) for count, total in counts)
    hits, alarms = (norm.ppf(wilson(*each)) for each in counts)
    low = hit - alarm - np.sqrt((hit - hits[0]) ** 2 + (alarms[1] - alarm) ** 2)
    return hit - alarm, low, hit - alarm + np.sqrt((hits[1] - hit) ** 2 + (alarm - alarms[0]) ** 2)


def wilson(count, total):
    """Return the limits as the solutions of the quadratic equation that defines them."""
    z, share = norm.ppf(0.975), count / total
    return np.sort(np.roots([1 + z**2 / total, -(2 * share + z**2 / total), share**2]).real)


def printed(number, digits=2):
    return f"{number:.{digits}f}".replace("-", "−")


def test_each_trainee_and_their_mean_have_sensitivity_with_its_interval(data, words):
    table, values = table_of(data), []
    for name in data.trainees:
        own = table["trainee"] == name
        value, low, high = d_prime(table["over"][own], table["refused"][own])
        assert f"{name} 100 {printed(value)} [{printed(low)}, {printed(high)}]" in words
        values.append(value)
    low, high = t_interval(np.array(values))
    assert f"mean 800 {printed(np.mean(values))} [{printed(low)}, {printed(high)}]" in words


def test_causes_are_sorted_by_the_share_missed_and_the_first_screen_names_the_first(
    data, words, page
):
    table = table_of(data)
    missed = table["over"] & ~table["refused"]
    rows, shares = [], []
    for fault in {str(each) for each in table["fault"][table["over"]]}:
        own = table["over"] & (table["fault"] == fault)
        count, total = int(missed[own].sum()), int(own.sum())
        low, high = 100 * wilson(count, total)
        share = f"{100 * count / total:.0f} % [{low:.0f}, {high:.0f}]"
        text = f"{fault} {total} {count} of {total} ({share})"
        rows.append((words.index(text), count / total))
    shares = [share for _, share in sorted(rows)]
    assert shares == sorted(shares, reverse=True)
    assert "Missed most: shifted skin, " in page.split("What differs")[0]
    assert "of so few cases" not in page


def test_learning_over_the_drills_is_tested_as_trials_are(data, words):
    table = table_of(data)
    values = np.empty((8, 5))
    for row, name in enumerate(data.trainees):
        for day in range(5):
            own = (table["trainee"] == name) & (table["day"] == day + 1)
            values[row, day] = d_prime(table["over"][own], table["refused"][own])[0]
    trend = decisions_of(data).trends[SENSITIVITY]
    assert trend.p == pytest.approx(page_trend_test(values).pvalue)
    assert trend.means == pytest.approx(values.mean(axis=0))
    for day, (low, high) in enumerate(map(t_interval, values.T)):
        middle = values[:, day].mean()
        row = f"Drill {day + 1} 8 {printed(middle)} [{printed(low)}, {printed(high)}]"
        assert row in words


def t_interval(values):
    reach = t.ppf(0.975, len(values) - 1) * np.std(values, ddof=1) / np.sqrt(len(values))
    return values.mean() - reach, values.mean() + reach


def test_drills_before_and_after_training_are_compared_by_trainee(data, words, page):
    sensitivity, cost = decisions_of(data).trained
    assert (sensitivity.outcome, cost.outcome) == (SENSITIVITY, COST)
    found = ttest_rel(sensitivity.second_means, sensitivity.first_means)
    low, high = found.confidence_interval(0.95)
    assert sensitivity.result.p == pytest.approx(found.pvalue)
    assert f"(95 % interval from {low:+.2f} to {high:+.2f})" in words
    ordered = np.sort([sensitivity.result.p, cost.result.p])
    assert min(sensitivity.adjusted_p, cost.adjusted_p) == pytest.approx(2 * ordered[0])
    assert "Only 8 trainees did a drill of decisions before and after training" in page


def test_a_study_without_drills_has_no_such_section_and_one_of_drills_alone_has_a_report(
    data, tmp_path
):
    with without_charts():
        assert "Decisions" not in words_of(report_html(cohort(2), "today"))
        write_report(replace(data, trials=()), tmp_path)
    alone = words_of((tmp_path / "report.html").read_text())
    assert "8 trainees · 0 trials · 40 drills" in alone
    assert "trainees passed their latest drill" in alone.split("What differs")[0]
    assert (tmp_path / "cases.csv").read_text() == cases_csv(data.drills)


def test_abandoned_drills_are_told_beside_the_others_and_are_no_trials(data):
    left = record_from_json(AbortedTrial, make_aborted(task="decide", touches=0))
    with without_charts():
        told = words_of(report_html(replace(data, aborted=(left,)), "today"))
        assert told.replace(" 1 drill more was abandoned.", "") == words_of(
            report_html(data, "today")
        )
    assert "1 drill more was abandoned" in told
