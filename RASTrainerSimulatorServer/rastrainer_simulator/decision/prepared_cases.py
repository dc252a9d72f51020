"""The cases of a drill, made ahead of time in a thread."""

from __future__ import annotations

from collections.abc import Collection
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING

from numpy.random import default_rng

from rastrainer.decision.drill_record import CASES, Fault
from rastrainer.scenario.scenario import Scenario

if TYPE_CHECKING:
    from rastrainer_simulator.decision.cases import CaseMaker, DecisionCase


_Form = tuple["CaseMaker", tuple[tuple[int, Fault], ...]]


def prepared_cases(
    scenario: Scenario, seed: int, seen: Collection[int]
) -> tuple[Future[DecisionCase], ...]:
    """Return the cases of a drill, which are made in a thread; the first after some seconds."""
    thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="cases")
    form = thread.submit(_form, scenario, seed, seen)
    cases = tuple(thread.submit(_case, form, row) for row in range(CASES))
    thread.shutdown(wait=False)
    return cases


def _form(scenario: Scenario, seed: int, seen: Collection[int]) -> _Form:
    # Only now: their import of scipy would delay the simulator's start.
    from rastrainer_simulator.decision.cases import CaseMaker
    from rastrainer_simulator.decision.forms import draw_form

    maker = CaseMaker(scenario)
    return maker, draw_form(maker, default_rng(seed), seen)


def _case(form: Future[_Form], row: int) -> DecisionCase:
    maker, keys = form.result()
    case = maker.case(*keys[row])
    if row == 0:
        # The first cut imports packages for seconds, which would stop the page.
        case.contours(case.target_mm)
    return case
