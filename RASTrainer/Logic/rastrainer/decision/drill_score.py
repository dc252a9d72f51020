"""The score of decisions: signal detection, cost, calibration of confidence, and ability.

A case is a signal if its error at the target is over the limit, and the answer "yes" is any
decision but to proceed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import NamedTuple

from rastrainer.decision.drill_record import CASES, DecidedCase, Decision, Fault
from rastrainer.registration.distributions import proportion

DRILL_SCORE_VERSION = "1"
HARM_COST, AGAIN_COST, STOP_COST, VAIN_COST, CHECK_COST = 10.0, 1.0, 2.0, 4.0, 0.1
"""Costs relative to a registration, which costs 1: to proceed beyond the limit, to register again,
to stop and look for the cause, to do either in vain, and to check a place. Our own convention."""
BELIEVER_COST, IDEAL_COST = 4.6, 1.8
"""Mean cost of a case for a trainee who trusts the residual, and for an ideal observer; measured on
simulated trainees (Testing/error_rates/tables.md)."""
MOST_HARMFUL, MOST_VAIN = 1, 2
"""A drill of twenty is passed with at most so many decisions to proceed beyond the limit, and so
many sound registrations refused: by 90 % of those who are right in 95 % of all cases, and by 1 % of
those who tell as much as the residual may, an area under the curve of 0.65."""

LEAST_RATE = 1e-3
"""A smaller rate, and one nearer to 1, is not told from this one."""
_NORMAL = NormalDist()
_Z95 = _NORMAL.inv_cdf(0.975)


def case_cost(case: DecidedCase) -> float:
    """Return the cost of a decision, without unit: a registration costs 1."""
    checks = CHECK_COST * len(case.checks)
    if case.decision is Decision.PROCEED:
        return checks + (0.0 if case.is_sound else HARM_COST)
    is_again = case.decision is Decision.REGISTER_AGAIN
    is_vain = case.is_sound or (is_again and not case.fault.is_repeatable)
    return checks + (AGAIN_COST if is_again else STOP_COST) + (VAIN_COST if is_vain else 0.0)


class DrillEstimate(NamedTuple):
    """A value with its 95 % interval."""

    value: float
    low: float
    high: float

    @property
    def interval(self) -> tuple[float, float]:
        return self.low, self.high


@dataclass(frozen=True)
class DrillScore:
    """The score of one or more drills.

    Attributes:
        sensitivity: d′; 0 for decisions that know nothing of the error.
        criterion: c; above 0 for who proceeds too easily.
        mean_cost: of a case (`case_cost`).
        score: 0 to 100; 0 costs as much as believing the residual, 100 as little as an ideal
            observer.
        brier: mean squared difference between the stated probability and 1 if right, else 0; 0.25
            for who always says 50 %.
        ability: of a Rasch model with the difficulties of the cases, logits.
        missed: by fault, of the cases over the limit: number of those with `proceed`, and of all.
    """

    cases: int
    harmful: int
    vain: int
    sensitivity: DrillEstimate
    criterion: DrillEstimate
    mean_cost: float
    score: float
    brier: float
    ability: DrillEstimate
    mean_checks: float
    mean_time_s: float
    missed: dict[Fault, tuple[int, int]]

    @property
    def is_passed(self) -> bool:
        share = self.cases / CASES
        return self.harmful <= MOST_HARMFUL * share and self.vain <= MOST_VAIN * share


def drill_score(cases: Sequence[DecidedCase]) -> DrillScore:
    """Return the score of at least one case.

    d′ = z(hits) − z(false alarms) and c = −(z(hits) + z(false alarms))/2 are of rates
    (k + ½)/(n + 1) (Hautus 1995).
    """
    signals = [case for case in cases if not case.is_sound]
    noise = [case for case in cases if case.is_sound]
    harmful = sum(case.decision is Decision.PROCEED for case in signals)
    vain = sum(case.decision is not Decision.PROCEED for case in noise)
    hits, alarms = _probit(len(signals) - harmful, len(signals)), _probit(vain, len(noise))
    # Halves; of the hits, the other way round.
    missed = DrillEstimate(*(-0.5 * z for z in (hits.value, hits.high, hits.low)))
    refused = DrillEstimate(*(0.5 * z for z in alarms))
    mean_cost = sum(map(case_cost, cases)) / len(cases)
    saved = (BELIEVER_COST - mean_cost) / (BELIEVER_COST - IDEAL_COST)
    return DrillScore(
        cases=len(cases),
        harmful=harmful,
        vain=vain,
        sensitivity=difference(hits, alarms),
        criterion=difference(missed, refused),
        mean_cost=mean_cost,
        score=100.0 * min(1.0, max(0.0, saved)),
        brier=sum((c.confidence / 100.0 - c.is_right) ** 2 for c in cases) / len(cases),
        ability=_ability(cases),
        mean_checks=sum(len(case.checks) for case in cases) / len(cases),
        mean_time_s=sum(case.time_s for case in cases) / len(cases),
        missed={
            fault: (sum(c.decision is Decision.PROCEED for c in of_fault), len(of_fault))
            for fault in Fault
            if (of_fault := [case for case in signals if case.fault is fault])
        },
    )


def difference(one: DrillEstimate, other: DrillEstimate) -> DrillEstimate:
    """Return one independent estimate minus another, such as d′ after and before training.

    Each end is off by the root of both squared distances (Zou and Donner 2008).
    """
    value = one.value - other.value
    below = math.hypot(one.value - one.low, other.high - other.value)
    above = math.hypot(one.high - one.value, other.value - other.low)
    return DrillEstimate(value, value - below, value + above)


def _probit(count: int, total: int) -> DrillEstimate:
    """Return z of a corrected rate, and of the ends of its interval (Wilson 1927)."""
    interval = proportion(count, total).interval if total else (0.0, 1.0)
    rates = (count + 0.5) / (total + 1.0), *interval
    return DrillEstimate(
        *(_NORMAL.inv_cdf(min(max(p, LEAST_RATE), 1.0 - LEAST_RATE)) for p in rates)
    )


def _ability(cases: Sequence[DecidedCase]) -> DrillEstimate:
    """Return the ability by maximum likelihood weighted with its information (Warm 1989)."""
    ability = 0.0
    for _ in range(100):
        right = [1.0 / (1.0 + math.exp(case.difficulty - ability)) for case in cases]
        information = sum(p * (1.0 - p) for p in right)
        skew = sum(p * (1.0 - p) * (1.0 - 2.0 * p) for p in right)
        score = sum(case.is_right - p for case, p in zip(cases, right, strict=True))
        step = (score + skew / (2.0 * information)) / information
        ability += max(-1.0, min(1.0, step))
        if abs(step) < 1e-9:
            break
    error = _Z95 / math.sqrt(information)
    return DrillEstimate(ability, ability - error, ability + error)
