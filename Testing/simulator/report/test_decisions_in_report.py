"""The report tells what decisions cost and miss, whether they get better, and how sure that is."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from scipy.stats import norm, page_trend_test, t, ttest_rel

from rastrainer.decision.drill_record import Decision, Fault
from rastrainer.json_records import record_from_json
from rastrainer.study.study_data import StudyData
from rastrainer.study.tidy_csv import cases_csv
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.report.decisions import COST, SENSITIVITY, decisions, decisions_of
from rastrainer_simulator.report.report import report_html, write_report
from Testing.domain.trial.trial_records import make_aborted
from Testing.drawn_drills import draw_drill, draw_drills
from Testing.error_rates import drills as error_rates
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
        "stated": np.array([case.confidence for _, case in cases]),
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


def test_each_trainee_has_sensitivity_with_its_interval(data, words):
    table = table_of(data)
    for name in data.trainees:
        own = table["trainee"] == name
        value, low, high = d_prime(table["over"][own], table["refused"][own])
        assert f"{name} 100 {printed(value)} [{printed(low)}, {printed(high)}]" in words


def test_the_mean_over_trainees_has_a_t_interval(data, words):
    table = table_of(data)
    own = (table["trainee"] == name for name in data.trainees)
    values = [d_prime(table["over"][each], table["refused"][each])[0] for each in own]
    reach = t.ppf(0.975, 7) * np.std(values, ddof=1) / np.sqrt(8)
    middle = np.mean(values)
    expected = f"{printed(middle)} [{printed(middle - reach)}, {printed(middle + reach)}]"
    assert f"mean 800 {expected}" in words


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


def test_calibration_is_told_with_its_interval(data, words):
    table = table_of(data)
    off = table["stated"] - 100 * (table["over"] == table["refused"])
    means = [off[table["trainee"] == name].mean() for name in data.trainees]
    reach = t.ppf(0.975, 7) * np.std(means, ddof=1) / np.sqrt(8)
    low, high = np.mean(means) - reach, np.mean(means) + reach
    assert low > 0
    expected = f"{np.mean(means):+.0f} percentage points [{low:+.0f}, {high:+.0f}]"
    assert f"The stated confidence was {expected}" in words


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
    shown = "is shown" if trend.adjusted_p < 0.05 else "is not shown; that is not evidence"
    assert (
        f"Sensitivity d′: that the trainees together get better from drill to drill {shown}"
        in words
    )


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
    assert "higher after training than before training" in words
    assert "finds a true difference in 80 % of studies only if" in words
    assert "Only 8 trainees did a drill of decisions before and after training" in page


def test_without_trials_between_two_drills_nothing_is_said_of_training(data):
    early = tuple(replace(trial, started_utc="2026-04-01T09:00:00Z") for trial in data.trials)
    assert decisions_of(replace(data, trials=early)).trained == ()
    with without_charts():
        words = words_of(decisions(decisions_of(replace(data, trials=early))))
    assert "No trainee did trials between two drills: nothing can be said about training." in words


def test_two_trainees_and_one_drill_are_described_without_a_test():
    random = np.random.default_rng(1)
    drills = tuple(draw_drill(random, name) for name in ("A", "B"))
    with without_charts():
        one = words_of(decisions(decisions_of(StudyData("One", (), drills=drills[:1]))))
        two = words_of(decisions(decisions_of(StudyData("Two", (), drills=drills))))
    assert "mean" not in re.search(r"Trainee n, cases.*? d′ is 0", one)[0]
    assert "mean 40" in two
    assert "Learning over the drills" not in two
    assert "get better" not in two


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


def test_names_are_texts_whatever_they_contain():
    odd = "$\\frac{1}$ & <script>alert(1)</script>"
    random = np.random.default_rng(2)
    drills = tuple(draw_drill(random, odd, day) for day in (1, 2))
    html = report_html(StudyData(odd, (), drills=drills), "today")
    assert "<script" not in html
    assert words_of(html).count(odd) > 3


def test_charts_have_descriptions_and_every_dot_says_its_numbers(data):
    html = decisions(decisions_of(data))
    charts = [
        ElementTree.fromstring(each) for each in re.findall(r"<svg.*?</svg>", html, re.DOTALL)
    ]
    described = [chart.get("aria-label") for chart in charts]
    assert described[0] == "Right decisions by stated confidence, %"
    assert described[1:3] == ["Sensitivity d′", "Cost of a case"]
    assert "of every trainee in both" in described[3]
    titles = [each.text for each in charts[0].iter("{http://www.w3.org/2000/svg}title")]
    stated = {case.confidence for drill in data.drills for case in drill.cases}
    assert len(titles) == len(stated)
    assert all(re.fullmatch(r"stated \d+ %: right in \d+ of \d+", title) for title in titles)


def test_planted_differences_are_recovered():
    """Of 20 trainees who gain 1.5 in d′, the report says so; of the same without gain, not."""
    better = decisions_of(studied(20, (0.8, 1.4, 1.8, 2.1, 2.3), seed=6))
    same = decisions_of(studied(20, (1.4,) * 5, seed=7))
    assert all(trend.is_shown for trend in better.trends.values())
    assert all(each.adjusted_p < 0.05 for each in better.trained)
    assert not any(trend.is_shown for trend in same.trends.values())
    assert not any(each.adjusted_p < 0.05 for each in same.trained)


def test_the_error_rates_are_of_the_d_prime_and_costs_of_the_program(data):
    for row in decisions_of(data).rows["T000"]:
        (drill,) = (each for each in data.drills if each.trial_id == row.trial_id)
        over = [case for case in drill.cases if not case.is_sound]
        hits = sum(case.is_right for case in over)
        alarms = sum(not case.is_right for case in drill.cases if case.is_sound)
        assert error_rates.sensitivity(hits, alarms) == pytest.approx(row.values["sensitivity"])


def test_abandoned_drills_are_told_beside_the_others_and_are_no_trials(data):
    left = record_from_json(AbortedTrial, make_aborted(task="decide", touches=0))
    with without_charts():
        told = words_of(report_html(replace(data, aborted=(left,)), "today"))
        assert told.replace(" 1 drill more was abandoned.", "") == words_of(
            report_html(data, "today")
        )
    assert "1 drill more was abandoned" in told
