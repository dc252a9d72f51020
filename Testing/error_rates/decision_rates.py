"""Rates of the drill of decisions: of simulated observers, cheats, passing, and its score."""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import NormalDist

import numpy as np
from numpy.random import Generator, default_rng
from scipy.stats import binom, rankdata

from rastrainer.decision.drill_record import CASES, Decision, Fault
from rastrainer.decision.drill_score import (
    BELIEVER_COST,
    IDEAL_COST,
    MOST_HARMFUL,
    MOST_VAIN,
    DrillEstimate,
    DrillScore,
    difference,
    drill_score,
)
from rastrainer.number_text import fixed
from rastrainer.scenario.points import NOSE_TIP
from rastrainer_simulator.decision.cases import (
    BACK,
    LEAST_DIFFICULTY,
    LIMIT_MM,
    SOUND_SLOPE,
    UNSOUND,
    UNSOUND_SLOPE,
)
from rastrainer_simulator.decision.forms import DIFFICULTY_SLACK
from Testing.error_rates import decision_traffic
from Testing.error_rates.decision_traffic import Traffic
from Testing.error_rates.decisions import (
    Ideal,
    Judged,
    Observer,
    Shown,
    always,
    area,
    believer,
    checker,
    decided,
    halves,
    ideal_observer,
    places,
    read,
)
from Testing.error_rates.measured import Measured, holds, share_of, share_text
from Testing.error_rates.row_files import stored_rows

OBSERVERS_HEADER = (
    "observer, 2,000 cases",
    "area under the curve",
    "decisions to proceed beyond the limit",
    "sound registrations refused",
    "mean cost of a case",
    "checks",
    "drills of twenty passed",
)
FAULTS_HEADER = (
    "fault, cases over the limit against all sound ones",
    "ideal observer",
    "two places",
    "residual",
    "missed by the ideal observer",
    "cases over the limit",
)
CHEATS_HEADER = (
    "cheat, with the threshold that suits it best",
    "drills passed",
    "area under the curve",
)
SCORES_HEADER = ("estimate", "interval contains the truth", "least and most often", "largest bias")
ABILITY_HEADER = ("planted ability", "interval contains it", "bias, logits")
DIFFICULTY_HEADER = ("difficulty, logits", "off by", "fitted to observers", "in the program")
LEAST_IDEAL, MOST_BELIEVER = 0.95, 0.65
MOST_PASSED = 0.01
COSTS = {"ideal": IDEAL_COST, "believes the residual": BELIEVER_COST}
COST_SLACK = 0.15
"""The mean costs of these observers may differ so much from those in the program."""
MIXED_FORMS, SAMPLED = 5000, 4000
"""Forms put together for the cheats, and how many of their values an area is computed from."""


def observers(_sets: int) -> list[Measured]:
    """Return what observers tell of the cases, and the cost of their decisions."""
    limits = {"ideal": (LEAST_IDEAL, None), "two places far apart": (MOST_BELIEVER, LEAST_IDEAL)}
    believers = {name: (None, MOST_BELIEVER) for name in OBSERVERS if name.startswith("believes")}
    limits |= believers
    return [_row(name, *limits.get(name, (None, None))) for name in OBSERVERS]


def _coin(_case: Shown, random: Generator) -> Judged:
    rating = float(random.random())
    return Judged(rating, Decision.REGISTER_AGAIN if rating > 0.5 else Decision.PROCEED)


OBSERVERS: dict[str, Callable[[Ideal], Observer]] = {
    "ideal": ideal_observer,
    "two places far apart": lambda _: checker(*places(NOSE_TIP, BACK)),
    "one place": lambda _: checker(*places(NOSE_TIP)),
    "believes the residual": lambda _: believer(lambda case: case.residual_mm),
    "believes the largest residual": lambda _: believer(lambda case: case.largest_mm),
    "believes the expected TRE": lambda _: believer(lambda case: case.expected_mm),
    "always registers again": lambda _: always(Decision.REGISTER_AGAIN),
    "always stops": lambda _: always(Decision.STOP),
    "always proceeds": lambda _: always(Decision.PROCEED),
    "decides by a coin": lambda _: _coin,
}


@functools.cache
def _judged(name: str) -> list[tuple[Shown, Judged]]:
    """Return all cases with what an observer made of them, by form and number."""
    random, found = default_rng(list(OBSERVERS).index(name)), []
    for cases, ideal in halves():
        observe = OBSERVERS[name](ideal)
        found += [(case, observe(case, random)) for case in cases]
    return sorted(found, key=lambda each: (each[0].form, each[0].number))


def _row(name: str, least: float | None, most: float | None) -> Measured:
    judged = _judged(name)
    score = drill_score([decided(*each) for each in judged])
    forms = itertools.groupby(judged, key=lambda each: each[0].form)
    passed = [drill_score([decided(*each) for each in own]).is_passed for _, own in forms]
    return Measured(
        name,
        area([each.rating for _, each in judged], [case.is_sound for case, _ in judged]),
        len(judged),
        most,
        least,
        also=lambda _: name not in COSTS or abs(score.mean_cost - COSTS[name]) <= COST_SLACK,
        further=(
            share_text(2 * score.harmful / score.cases),
            share_text(2 * score.vain / score.cases),
            fixed(score.mean_cost, 2),
            fixed(score.mean_checks, 1),
            share_text(share_of(passed)),
        ),
    )


def by_fault(_sets: int) -> list[Measured]:
    """Return how well observers separate unsound cases of each fault from all sound cases."""
    ideal = _judged("ideal")
    two = _judged("two places far apart")
    rows = []
    for fault in Fault:
        chosen = [
            row for row, (case, _) in enumerate(ideal) if case.is_sound or case.fault == fault.value
        ]
        sound = [ideal[row][0].is_sound for row in chosen]
        over = [ideal[row][1] for row in chosen if not ideal[row][0].is_sound]
        rows.append(
            Measured(
                fault.value,
                area([ideal[row][1].rating for row in chosen], sound),
                len(over),
                at_least=LEAST_IDEAL,
                further=(
                    share_text(area([two[row][1].rating for row in chosen], sound)),
                    share_text(area([ideal[row][0].residual_mm for row in chosen], sound)),
                    share_text(share_of([each.decision is Decision.PROCEED for each in over])),
                    str(len(over)),
                ),
            )
        )
    return rows


def cheats(_sets: int) -> list[Measured]:
    """Return how many forms a trainee passes without any check.

    Each cheat refuses above, or below, one threshold for all forms, the best there is. Residuals
    and expected TRE, which `draw_form` makes useless, are tried on the stored forms; all else is
    tried on many forms put together from their cases.
    """
    cases = _stored()
    sound = np.array([case.is_sound for case in cases])
    rows = np.arange(len(cases)).reshape(-1, CASES)
    found = [
        _cheat(f"{name}, stored forms", np.array(values)[rows], sound[rows], MOST_PASSED)
        for name, values in {
            "the residual": [case.residual_mm for case in cases],
            "the largest residual": [case.largest_mm for case in cases],
            "the expected TRE": [case.expected_mm for case in cases],
        }.items()
    ]
    rows = _mixed(sound)
    beyond, part = ~sound, np.array([case.form % 2 for case in cases])
    learned = _learned([_features(case) for case in cases], beyond, part)[rows]
    left = _left(sound[rows])
    named = {
        "the number of points": np.array([case.points for case in cases])[rows],
        "the method": np.array([len(case.method) for case in cases])[rows],
        "the size of a message with all that is shown": np.array([*map(_bytes, cases)])[rows],
        "the seed": np.array([case.seed for case in cases], dtype=float)[rows],
        "the seed's last bit": np.array([case.seed % 2 for case in cases])[rows],
        "the number in the form": np.broadcast_to(np.arange(CASES), rows.shape),
        "how many sound ones are left, as each truth is told": left,
    }
    found += [_cheat(name, each, sound[rows], MOST_PASSED) for name, each in named.items()]
    evidence = {
        "no cheat: all that is shown, learned from other forms": learned,
        "no cheat: the same, with how many sound ones are left": learned + left,
    }
    found += _traffic_cheats()
    return [*found, *(_cheat(name, each, sound[rows]) for name, each in evidence.items())]


MEASURED = {
    "the time until a case appears": "waited_ms",
    "the time of a check": "checked_ms",
    "the time until the images appear": "sliced_ms",
    "the number of rows of places": "rows",
    "the number of the first point": "first_label",
    "the order of the points": "order",
    "the size of the images in bytes": "slices_bytes",
    "the number of points of the contours": "contour_points",
    "the digits of the fiducials' places": "digits",
    "the growth of the journal": "journal_bytes",
    "the time of the journal's file": "journal_ns",
}
"""Cheats by measuring at a client or in the folder, with the names of the measured values."""


def _traffic_cheats() -> list[Measured]:
    """Return how many forms are passed by measurements of played drills.

    All together are weighed by a regression that is learned from other forms. It must not tell
    more than chance does, with 95 %.
    """
    played: list[Traffic] = stored_rows(decision_traffic.FILE, Traffic)
    sound = np.array([each.is_sound == 1 for each in played])
    values = np.array([[getattr(each, name) for name in MEASURED.values()] for each in played])
    rows = _mixed(sound)
    found = [
        _cheat(name, of_name, sound[rows], MOST_PASSED)
        for name, of_name in zip(MEASURED, np.moveaxis(values[rows], 2, 0), strict=True)
    ]
    part = np.array([each.form % 2 for each in played])
    # Times have long tails, and the first case waits for its form.
    ranks = rankdata(values, axis=0) / len(values)
    learned = _learned(ranks, ~sound, part)
    whole = _cheat(
        "all of these, learned from other forms", learned[rows], sound[rows], MOST_PASSED
    )
    own, halves_of = area(learned, sound), (np.sum(sound), np.sum(~sound))
    chance = math.sqrt((sum(halves_of) + 1) / (12.0 * halves_of[0] * halves_of[1]))
    reach = _NORMAL.inv_cdf(0.975) * chance
    told = f"{share_text(own)}, chance {share_text(0.5 - reach)} to {share_text(0.5 + reach)}"
    is_chance = own <= 0.5 + reach
    return [*found, replace(whole, further=(told,), also=lambda _: is_chance)]


def _cheat(
    name: str, values: np.ndarray, sound: np.ndarray, at_most: float | None = None
) -> Measured:
    """Return the share of forms that pass; values and soundness are (forms, 20)."""
    own = area(values.ravel()[:SAMPLED], sound.ravel()[:SAMPLED])
    share = best_share(values, sound)
    return Measured(name, share, len(values), at_most, further=(share_text(max(own, 1.0 - own)),))


def _mixed(sound: np.ndarray) -> np.ndarray:
    """Return rows of cases, (forms, 20) int, half of them sound, in an order of chance."""
    random = default_rng(4)
    half = (MIXED_FORMS, CASES // 2)
    rows = np.column_stack([random.choice(np.flatnonzero(of), half) for of in (sound, ~sound)])
    return random.permuted(rows, axis=1)


def best_share(values: np.ndarray, sound: np.ndarray) -> float:
    """Return the largest share of forms that one threshold passes, from above or below."""
    best = 0.0
    for shown in (values, -values):
        for limit in np.unique(np.quantile(shown, np.linspace(0.0, 1.0, 101))):
            is_refused = shown > limit
            harmful = np.sum(~is_refused & ~sound, axis=1)
            vain = np.sum(is_refused & sound, axis=1)
            best = max(best, float(np.mean((harmful <= MOST_HARMFUL) & (vain <= MOST_VAIN))))
    return best


def _bytes(case: Shown) -> float:
    """Return about how long a message with points, residuals and trace is."""
    trace = 0 if case.method == "fiducials" else 120
    return 60.0 * case.points + 24.0 * trace + len(f"{case.residual_mm:g}{case.expected_mm:g}")


def _features(case: Shown) -> list[float]:
    residual, largest, expected = map(
        math.log, (case.residual_mm, case.largest_mm, case.expected_mm)
    )
    one_hot = [float(case.method == method) for method in ("fiducials", "landmarks")]
    return [residual, largest, expected, math.log(case.points), *one_hot]


def _learned(
    features: Sequence[Sequence[float]] | np.ndarray, beyond: np.ndarray, part: np.ndarray
) -> np.ndarray:
    """Return log odds of an error beyond the limit by features, learned from the other part.

    It is a logistic regression on the features, their squares and products.
    """
    values = np.array(features)
    values = (values - values.mean(axis=0)) / np.maximum(values.std(axis=0), 1e-9)
    pairs = itertools.combinations_with_replacement(values.T, 2)
    columns = np.column_stack([np.ones(len(values)), values, *(a * b for a, b in pairs)])
    found = np.empty(len(values))
    for each in (0, 1):
        known, own = columns[part != each], np.zeros(columns.shape[1])
        for _ in range(25):
            chance = 1.0 / (1.0 + np.exp(-known @ own))
            slope = known.T @ (beyond[part != each] - chance) - own
            curve = (known.T * (chance * (1.0 - chance))) @ known + np.eye(len(own))
            own += np.linalg.solve(curve, slope)
        found[part == each] = columns[part == each] @ own
    return found


def _left(sound: np.ndarray) -> np.ndarray:
    """Return the log odds of an error by the cases that are left, (forms, 20)."""
    beyond = CASES // 2 - np.cumsum(~sound, axis=1) + ~sound
    return np.log(beyond + 1e-3) - np.log(CASES - np.arange(CASES) - beyond + 1e-3)


PASSING_HEADER = ("trainee", "drills of twenty passed")
_NORMAL = NormalDist()


def passing(_sets: int) -> list[Measured]:
    """Return how often trainees of known error rates pass a drill: exactly, by both binomials."""
    half = CASES // 2

    def passed(missed: float, refused: float) -> float:
        few = binom.cdf(MOST_HARMFUL, half, missed) * binom.cdf(MOST_VAIN, half, refused)
        return float(few)

    def at_best(sensitivity: float) -> float:
        criteria = np.linspace(-1.5, 1.5, 301)
        return max(passed(*_rates(sensitivity, each)) for each in criteria)

    rows = [
        Measured(
            f"right in {100 - round(100 * rate)} % of all cases", passed(rate, rate), 1, *limits
        )
        for rate, limits in {0.03: (), 0.05: (None, 0.9), 0.1: (), 0.2: (0.3,), 0.3: (0.1,)}.items()
    ]
    for name, area_under in {
        "guesses": 0.5,
        "tells as much as a residual may": MOST_BELIEVER,
    }.items():
        sensitivity = math.sqrt(2.0) * _NORMAL.inv_cdf(area_under)
        words = f"{name} (area {share_text(area_under, 0)}), with the criterion that passes most"
        rows.append(Measured(words, at_best(sensitivity), 1, MOST_PASSED))
    return rows


def _rates(sensitivity: float, criterion: float) -> tuple[float, float]:
    """Return the shares of missed errors and of refused sound registrations."""
    missed = _NORMAL.cdf(criterion - sensitivity / 2.0)
    return missed, _NORMAL.cdf(-criterion - sensitivity / 2.0)


PLANTED = tuple(itertools.product((0.5, 1.0, 1.5, 2.0), (-0.3, 0.0, 0.3)))
"""d′ and criterion of simulated trainees."""
GAINS = (0.0, 0.5, 1.0)
LEAST_HELD, MOST_HELD = 0.93, 0.97


def scores(sets: int) -> list[Measured]:
    """Return how often the intervals of d′, criterion and learning contain planted values.

    Learning is d′ of so many cases minus d′ of as many before.
    """
    rows = []
    for count in (20, 40, 100):
        random = default_rng(count)
        found: dict[str, list[tuple[float, float]]] = {"d′": [], "criterion": [], "learning": []}
        for sensitivity, criterion in PLANTED:
            before = _drills(count, sensitivity, criterion, sets, random)
            of_both = [each.sensitivity for each in before]
            found["d′"].append(_recovered(sensitivity, of_both))
            found["criterion"].append(_recovered(criterion, [each.criterion for each in before]))
            for gain in GAINS:
                after = _drills(count, sensitivity + gain, criterion, sets, random)
                changes = map(difference, (each.sensitivity for each in after), of_both)
                found["learning"].append(_recovered(gain, list(changes)))
        for name, own in found.items():
            held = [each for each, _ in own]
            bias = max((off for _, off in own), key=abs)
            rows.append(
                Measured(
                    f"{name}, {count} cases",
                    share_of(held),
                    len(own) * sets,
                    MOST_HELD,
                    LEAST_HELD,
                    further=(f"{share_text(min(held))} to {share_text(max(held))}", fixed(bias, 2)),
                )
            )
    return rows


def _recovered(truth: float, estimates: Sequence[DrillEstimate]) -> tuple[float, float]:
    """Return how often intervals contain the truth, and the bias of the values."""
    held = share_of([holds(each.interval, truth) for each in estimates])
    return held, float(np.mean([each.value for each in estimates])) - truth


def _drills(
    count: int, sensitivity: float, criterion: float, sets: int, random: Generator
) -> list[DrillScore]:
    missed, refused = _rates(sensitivity, criterion)
    of_half = random.binomial(count // 2, (missed, refused), (sets, 2))
    return [_score(count, *each) for each in of_half.tolist()]


@functools.cache
def _score(count: int, harmful: int, vain: int) -> DrillScore:
    """Return the score of a drill, half of whose cases are sound, with so many errors."""
    half = count // 2
    proceed, again = Judged(0.0, Decision.PROCEED), Judged(1.0, Decision.REGISTER_AGAIN)
    beyond, sound = _plain(2.0 * LIMIT_MM), _plain(0.5 * LIMIT_MM)
    return drill_score(
        [decided(beyond, proceed if row < harmful else again) for row in range(half)]
        + [decided(sound, again if row < vain else proceed) for row in range(half)]
    )


def _plain(error_mm: float, of_difficulty: float = 0.0) -> Shown:
    return Shown(
        form=0,
        number=0,
        seed=0,
        fault=Fault.NONE.value,
        method="fiducials",
        points=0,
        difficulty=of_difficulty,
        residual_mm=1.0,
        largest_mm=1.0,
        expected_mm=1.0,
        error=(error_mm, 0.0, 0.0),
        offsets=(),
    )


ABILITIES = (-2.0, -1.0, 0.0, 1.0)


def abilities(sets: int) -> list[Measured]:
    """Return how often the interval of the ability contains a planted one, on stored forms."""
    rows = []
    of_forms = _difficulties().ravel()
    for count, ability in itertools.product((20, 40, 100), ABILITIES):
        random = default_rng([count, round(100 * ability + 1000)])
        found = []
        for _ in range(sets):
            first = CASES * int(random.integers((len(of_forms) - count) // CASES + 1))
            own = of_forms[first : first + count]
            is_right = random.random(count) < 1.0 / (1.0 + np.exp(own - ability))
            found.append(_ability(own.tolist(), is_right.tolist()))
        bias = float(np.mean([each.value for each in found])) - ability
        rows.append(
            Measured(
                f"{fixed(ability, 0)} logits, {count} cases",
                share_of([holds(each.interval, ability) for each in found]),
                len(found),
                at_least=LEAST_HELD,
                further=(fixed(bias, 2),),
            )
        )
    return rows


def _difficulties() -> np.ndarray:
    """Return the difficulties of stored forms, (forms, 20) float, logits."""
    return np.reshape([case.difficulty for case in _stored()], (-1, CASES))


def _stored() -> list[Shown]:
    """Return all cases, by form and number."""
    cases = (case for part, _ in halves() for case in part)
    return sorted(cases, key=lambda case: (case.form, case.number))


def _ability(difficulties: list[float], is_right: list[bool]) -> DrillEstimate:
    answers = (Decision.PROCEED if right else Decision.STOP for right in is_right)
    pairs = zip(difficulties, answers, strict=True)
    sound = (decided(_plain(0.5 * LIMIT_MM, each), Judged(0.0, answer)) for each, answer in pairs)
    return drill_score(list(sound)).ability


LEVELS = {0.4: 6, 0.8: 5, 1.2: 4, 1.6: 4, 2.4: 3, 3.5: 2, 5.0: 2}
"""Observers of spread ability: their reading errors, mm, and how many places they check."""
DOUBT = 0.4
"""They refuse a registration that is beyond the limit with this probability."""
COEFFICIENT_SLACK = 0.4


def difficulties(_sets: int) -> list[Measured]:
    """Return the coefficients of a case's difficulty as fitted to observers of spread ability."""
    spread = float(_difficulties().mean(axis=1).std(ddof=1))
    named = {each.value: each.difficulty for each in Fault}
    named |= {
        "margin of a sound case": -SOUND_SLOPE,
        "beyond the limit": UNSOUND,
        "margin beyond the limit": -UNSOUND_SLOPE,
    }
    rows = [
        _off_by(
            name, COEFFICIENT_SLACK, abs(max(found, LEAST_DIFFICULTY) - value), found, f"{value:g}"
        )
        for (name, value), found in zip(named.items(), _fitted(), strict=True)
    ]
    return [_off_by("mean of a form, SD over forms", DIFFICULTY_SLACK, spread, spread, "0"), *rows]


def _off_by(name: str, slack: float, off: float, found: float, in_program: str) -> Measured:
    further = (fixed(found, 2), in_program.replace("-", "−"))
    return Measured(name, off, at_most=slack, is_share=False, further=further)


def _fitted() -> np.ndarray:
    """Return the coefficients that make the right decisions of all observers most likely.

    A Rasch model, logit p = ability − difficulty, with the difficulty linear in the coefficients;
    the mean ability is 0.
    """
    cases = [(case, ideal) for part, ideal in halves() for case in part]
    margins = np.log([case.true_mm / LIMIT_MM for case, _ in cases])
    beyond = (margins > 0.0).astype(float)
    faults = [[float(case.fault == fault.value) for fault in Fault] for case, _ in cases]
    sizes = np.abs(margins)
    columns = np.column_stack([faults, sizes * (1.0 - beyond), beyond, sizes * beyond])
    random, right = default_rng(3), []
    for reading_mm, count in LEVELS.items():
        refused = []
        for case, ideal in cases:
            looks = (read(case, place, random, reading_mm) for place in ideal.order[:count])
            refused.append(ideal.beyond([*itertools.chain(*looks)], reading_mm)[0] > DOUBT)
        right.append(np.array(refused) == (beyond > 0.0))
    answers, levels = np.array(right, dtype=float), len(LEVELS)
    ability, found = np.zeros(levels), np.zeros(columns.shape[1])
    design = np.vstack(
        [
            np.column_stack([np.tile(np.eye(levels)[each], (len(cases), 1)), -columns])
            for each in range(levels)
        ]
    )
    both = np.concatenate([ability, found])
    for _ in range(30):
        chance = 1.0 / (1.0 + np.exp(-design @ both))
        # A weak prior limits faults that no observer misses; a strong one centers the abilities.
        weak = np.full(len(both), 0.5)
        slope = design.T @ (answers.ravel() - chance) - weak * both
        curve = (design.T * (chance * (1.0 - chance))) @ design + np.diag(weak)
        curve[:levels, :levels] += 1e4
        slope[:levels] -= 1e4 * both[:levels].sum()
        both += np.linalg.solve(curve, slope)
    return both[levels:]
