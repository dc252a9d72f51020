"""Simulated observers of the drill of decisions, and the cases that they see.

`decisions.csv` has the cases of a hundred forms on Colin27, and what can be seen of each. `python
-m Testing.error_rates.decisions` draws the forms that it lacks.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.random import Generator, default_rng

from rastrainer import transforms
from rastrainer.decision.drill_record import (
    CASES,
    CHECK_S,
    MAX_CHECKS,
    DecidedCase,
    Decision,
    Fault,
)
from rastrainer.decision.drill_score import AGAIN_COST, HARM_COST, STOP_COST, VAIN_COST
from rastrainer.head.mesh import outward_normals
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import load_scenario
from rastrainer.transforms import frame_along
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.decision.cases import LIMIT_MM, NEVER_SOUND, CaseMaker, DecisionCase
from rastrainer_simulator.decision.forms import draw_form
from Testing.error_rates.row_files import Floats, add_row, stored_rows

FILE = Path(__file__).with_name("decisions.csv")
FORMS = 100
KEYS = set(itertools.product(range(FORMS), range(CASES)))
"""Form and number of each stored case."""
READING_MM = 0.8
"""Standard deviation, on each axis, of what an observer reads of a check's picture."""
STOPPED_MM = 0.5
"""Height above the skin from which a tip is seen to have stopped above it."""
SURE = 0.03
"""The ideal observer stops checking if it is this sure."""
TOLERATED = 1.25
"""Distance along the skin, relative to the limit, that an observer of one or two checks accepts."""
SCALES = np.geomspace(0.1, 4.0, 12)
"""Sizes of errors that the ideal observer expects, relative to the limit."""
DRAWS = default_rng(0).normal(size=(200, 3))


@dataclass(frozen=True)
class Shown:
    """A case, and what can be seen of it.

    Attributes:
        largest_mm: the largest residual of a touched point.
        error: (3,), at the target, RAS mm.
        offsets: at each anatomical place, from the place to the tip: twice along the skin and once
            outward, mm.
    """

    form: int
    number: int
    seed: int
    fault: str
    method: str
    points: int
    difficulty: float
    residual_mm: float
    largest_mm: float
    expected_mm: float
    error: Floats
    offsets: Floats

    @property
    def true_mm(self) -> float:
        return float(np.linalg.norm(self.error))

    @property
    def is_sound(self) -> bool:
        return self.true_mm <= LIMIT_MM


class Watcher:
    """Looks at cases of a scenario."""

    def __init__(self, name: str = "colin27") -> None:
        self.maker = CaseMaker(load_scenario(asset_path("scenarios", name)))
        self.places = list(self.maker.places)
        normals = outward_normals(self.maker.mesh, list(self.maker.places.values()))
        self.frames = np.array([frame_along(normal) for normal in normals])
        self.to_head = transforms.inverse(self.maker.scenario.head_to_world)

    def shown(self, form: int, number: int, case: DecisionCase) -> Shown:
        places = [case.places[name] for name in self.places]
        offsets = [self.to_head[:3, :3] @ (case.tip_for(p) - case.truly(p)) for p in places]
        goes = transforms.apply(transforms.inverse(case.registration), case.target_mm)
        error = self.to_head[:3, :3] @ (goes - case.truly(case.target_mm))
        along = np.einsum("nij,nj->ni", self.frames, np.array(offsets))
        return Shown(
            form=form,
            number=number,
            seed=case.seed,
            fault=case.fault.value,
            method=case.method.value,
            points=len(case.labels),
            difficulty=round(case.difficulty, 3),
            residual_mm=round(case.residual_mm, 3),
            largest_mm=round(float(case.residuals_mm.max()), 3),
            expected_mm=round(case.expected.expected_mm, 3),
            error=tuple(error.round(3).tolist()),
            offsets=tuple(along.round(1).ravel().tolist()),
        )

    def form(self, number: int) -> list[Shown]:
        made = draw_form(self.maker, default_rng([number, 39]), ())
        return [self.shown(number, place, case) for place, case in enumerate(made)]


class Ideal:
    """An observer that knows all distributions, learned from cases.

    Offsets and error of a fault's cases are normal with mean zero and a covariance that is
    proportional to a squared size: a mixture over faults and sizes.
    """

    def __init__(self, known: Sequence[Shown]) -> None:
        faults = sorted({each.fault for each in known})
        shapes, weights, names = [], [], []
        for fault in faults:
            own = [each for each in known if each.fault == fault]
            sizes = np.array([each.true_mm for each in own])
            values = np.array([(*each.offsets, *each.error) for each in own]) / sizes[:, None]
            shape = values.T @ values / len(own)
            shape[np.diag_indices(len(shape))] *= 1.02
            relative = np.abs(np.log(sizes[:, None] / LIMIT_MM / SCALES)).argmin(axis=1)
            counts = np.bincount(relative, minlength=len(SCALES)) + 0.3
            for count, scale in zip(counts, SCALES, strict=True):
                shapes.append((scale * LIMIT_MM) ** 2 * shape)
                weights.append(count / counts.sum() * len(own))
                names.append(Fault(fault))
        self.covariances, self.weights = np.array(shapes), np.array(weights) / np.sum(weights)
        self.never = np.array([name in NEVER_SOUND for name in names])
        self.is_repeatable = np.array([name.is_repeatable for name in names])
        self.order = self._order()

    def _order(self) -> list[int]:
        """Return the places, the next one always that which tells most of the usual error."""
        pooled = np.tensordot(self.weights, np.minimum(self.covariances, 1e3), axes=1)
        count = (len(pooled) - 3) // 3
        chosen: list[int] = []
        while len(chosen) < count:
            left = [place for place in range(count) if place not in chosen]
            chosen.append(min(left, key=lambda place: self._left(pooled, [*chosen, place])))
        return chosen

    @staticmethod
    def _left(pooled: np.ndarray, places: list[int]) -> float:
        rows = [3 * place + axis for place in places for axis in (0, 1)]
        seen = pooled[np.ix_(rows, rows)] + READING_MM**2 * np.eye(len(rows))
        cross = pooled[-3:, rows]
        return float(np.trace(pooled[-3:, -3:] - cross @ np.linalg.solve(seen, cross.T)))

    def beyond(
        self, found: Sequence[tuple[int, float]], reading_mm: float = READING_MM
    ) -> tuple[float, float]:
        """Return the probability of an error beyond the limit, and that it is repeatable, too."""
        rows, values = [row for row, _ in found], [value for _, value in found]
        seen = self.covariances[:, rows][:, :, rows] + reading_mm**2 * np.eye(len(rows))
        cross, read = self.covariances[:, -3:][:, :, rows], np.array(values)
        solved = np.linalg.solve(seen, np.swapaxes(cross, 1, 2))
        mean = np.einsum("fre,r->fe", solved, read)
        left = self.covariances[:, -3:, -3:] - cross @ solved
        quadratic = np.einsum(
            "r,fr->f",
            read,
            np.linalg.solve(seen, np.broadcast_to(read[:, None], (len(seen), len(rows), 1)))[
                ..., 0
            ],
        )
        log = np.log(self.weights) - (quadratic + np.linalg.slogdet(seen)[1]) / 2.0
        likely = np.exp(log - log.max())
        likely /= likely.sum()
        used = np.flatnonzero(likely > 1e-4)
        variances, axes = np.linalg.eigh(left[used])
        roots = axes * np.sqrt(np.maximum(variances, 0.0))[:, None, :]
        errors = mean[used, None] + DRAWS @ np.swapaxes(roots, 1, 2)
        is_beyond = (np.linalg.norm(errors, axis=2) > LIMIT_MM).mean(axis=1)
        is_beyond = np.where(self.never[used], 1.0, is_beyond) * likely[used]
        return float(is_beyond.sum()), float(is_beyond[self.is_repeatable[used]].sum())


@dataclass(frozen=True)
class Judged:
    """What an observer makes of a case; the larger the rating, the more it doubts."""

    rating: float
    decision: Decision
    checks: int = 0


Observer = Callable[[Shown, Generator], Judged]


def cheapest(beyond: float, repeatable: float) -> Decision:
    """Return the decision of the least expected cost.

    Both are probabilities: of an error beyond the limit, and that it is repeatable, too.
    """
    costs = {
        Decision.PROCEED: HARM_COST * beyond,
        Decision.REGISTER_AGAIN: AGAIN_COST + VAIN_COST * (1.0 - repeatable),
        Decision.STOP: STOP_COST + VAIN_COST * (1.0 - beyond),
    }
    return min(costs, key=lambda decision: costs[decision])


def read(
    case: Shown, place: int, random: Generator, reading_mm: float = READING_MM
) -> list[tuple[int, float]]:
    """Return rows of `offsets` and their values as read at a place; the height only above skin."""
    rows = [3 * place, 3 * place + 1, 3 * place + 2]
    values = [case.offsets[row] + random.normal(0.0, reading_mm) for row in rows]
    shown = 3 if values[2] > STOPPED_MM else 2
    return list(zip(rows, values, strict=True))[:shown]


def ideal_observer(ideal: Ideal) -> Observer:
    """Return who checks the places that tell most until sure enough, and saves all costs."""

    def judge(case: Shown, random: Generator) -> Judged:
        found: list[tuple[int, float]] = []
        for place in ideal.order[:MAX_CHECKS]:
            found += read(case, place, random)
            beyond, repeatable = ideal.beyond(found)
            if not SURE < beyond < 1.0 - SURE:
                break
        return Judged(beyond, cheapest(beyond, repeatable), ideal.order.index(place) + 1)

    return judge


def checker(*places: int) -> Observer:
    """Return an observer who registers again if the tip misses one of these places by too much."""

    def judge(case: Shown, random: Generator) -> Judged:
        beside = [
            np.hypot(*(value for _, value in read(case, each, random)[:2])) for each in places
        ]
        return _again_above(float(max(beside)), TOLERATED * LIMIT_MM, len(places))

    return judge


def believer(value: Callable[[Shown], float]) -> Observer:
    """Return who registers again if a value that is shown is above the limit, and never checks."""
    return lambda case, _random: _again_above(value(case), LIMIT_MM)


def always(decision: Decision) -> Observer:
    return lambda _case, _random: Judged(0.0, decision)


def _again_above(value: float, most: float, checks: int = 0) -> Judged:
    decision = Decision.REGISTER_AGAIN if value > most else Decision.PROCEED
    return Judged(value, decision, checks)


def decided(case: Shown, judged: Judged) -> DecidedCase:
    """Return an observer's case as a drill records it."""
    return DecidedCase(
        seed=case.seed,
        fault=Fault(case.fault),
        method=RegistrationMethod(case.method),
        limit_mm=LIMIT_MM,
        true_error_mm=case.true_mm,
        expected_error_mm=case.expected_mm,
        residual_mm=case.residual_mm,
        difficulty=case.difficulty,
        checks=tuple(map(str, range(judged.checks))),
        decision=judged.decision,
        confidence=50,
        time_s=CHECK_S * judged.checks,
    )


@functools.cache
def places(*names: str) -> tuple[int, ...]:
    """Return the numbers of anatomical places."""
    return tuple(map(Watcher().places.index, names))


@functools.cache
def halves() -> tuple[tuple[list[Shown], Ideal], ...]:
    """Return the cases of every other form with what an ideal observer learned from the others."""
    shown: list[Shown] = stored_rows(FILE, Shown)
    parts = [[each for each in shown if each.form % 2 == part] for part in (0, 1)]
    return (parts[0], Ideal(parts[1])), (parts[1], Ideal(parts[0]))


def area(ratings: Sequence[float], sound: Sequence[bool]) -> float:
    """Return the area under the curve: how often an unsound case is rated above a sound one."""
    ratings, sound = np.asarray(ratings), np.asarray(sound)
    high, low = ratings[~sound], ratings[sound]
    return float(np.mean((high[:, None] > low) + 0.5 * (high[:, None] == low)))


def main() -> None:
    known = {each.form for each in stored_rows(FILE, Shown)} if FILE.exists() else set()
    watcher = Watcher()
    for number in range(FORMS):
        if number not in known:
            for row in watcher.form(number):
                add_row(FILE, row)


if __name__ == "__main__":
    main()
