"""Forms of a drill: twenty cases, half of them sound, alike in difficulty.

Each case of a half is drawn on its own, so a form's order and its earlier cases tell as little as
can be of the next one. In no form do residuals or the expected error tell much: nobody should pass
a drill, or learn to trust a residual, by luck.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.random import Generator

from rastrainer.decision.drill_record import CASES, FAULTS, Fault
from rastrainer_simulator.decision.cases import LIMIT_MM, NEVER_SOUND, CaseMaker, DecisionCase

WITHOUT_FAULT = 0.25
"""Probability that a sound case has no fault; other sound cases have a small one."""
SMALL_FAULTS = tuple(fault for fault in FAULTS if fault not in NEVER_SOUND)
TRIES = 30
"""Cases that are made with one fault until its error is small, or large, enough."""
MEAN_DIFFICULTY, DIFFICULTY_SLACK = -2.2, 0.1
"""Mean difficulty of a form's cases, logits, and how far from it a form may be."""
MOST_TOLD = 0.6
"""Area under the curve of one shown value in a form: how often it is larger in a case beyond the
limit than in a sound one. A limit of the value that would pass a drill needs 0.72."""
MOST_CHANGES = 300
"""Cases that are drawn in place of others; on Colin27, some ten do."""
SEED_LIMIT = 2**53
"""Whole numbers below it are exact in every reader of JSON."""


def draw_form(
    maker: CaseMaker, random: Generator, seen: Collection[int]
) -> tuple[DecisionCase, ...]:
    """Return the cases of a form, none of whose seeds was seen before; it takes seconds."""
    used = set(seen)

    def drawn(is_sound: bool) -> DecisionCase:
        faults = SMALL_FAULTS if is_sound else tuple(Fault)
        while True:
            is_without = is_sound and random.random() < WITHOUT_FAULT
            fault = Fault.NONE if is_without else faults[random.integers(len(faults))]
            for seed in map(int, random.integers(SEED_LIMIT, size=TRIES)):
                if seed in used or (maker.guess_mm(seed, fault) <= LIMIT_MM) != is_sound:
                    continue
                case = maker.case(seed, fault)
                if case.is_sound == is_sound:
                    used.add(seed)
                    return case

    form = [drawn(place % 2 == 0) for place in random.permutation(CASES)]
    for _ in range(MOST_CHANGES):
        if not (off := _off(form)):
            break
        changed, place = [*form], int(random.integers(CASES))
        changed[place] = drawn(form[place].is_sound)
        if _off(changed) < off:
            form = changed
    return tuple(form)


def _off(form: list[DecisionCase]) -> float:
    """Return by how much a form misses its requirements, relative to the limits."""
    mean = float(np.mean([case.difficulty for case in form]))
    off = max(abs(mean - MEAN_DIFFICULTY) / DIFFICULTY_SLACK - 1.0, 0.0)
    is_sound = np.array([case.is_sound for case in form])
    shown = [
        (case.residual_mm, case.residuals_mm.max(), case.expected.expected_mm) for case in form
    ]
    for values in np.array(shown).T:
        told = np.mean(values[~is_sound][:, None] > values[is_sound])
        off += max(float(told) / MOST_TOLD - 1.0, 0.0)
    return off
