"""A form has twenty new cases, half of them sound, which no residual and no order gives away."""

from functools import cache

import numpy as np
import pytest

from rastrainer.decision.drill_record import CASES, Fault
from rastrainer.decision.drill_score import MOST_HARMFUL, MOST_VAIN
from rastrainer_simulator.decision.cases import NEVER_SOUND, CaseMaker
from rastrainer_simulator.decision.forms import DIFFICULTY_SLACK, MEAN_DIFFICULTY, draw_form
from Testing.error_rates.decisions import FILE, Shown, Watcher
from Testing.error_rates.hands import scenario_of
from Testing.error_rates.row_files import stored_rows


@cache
def stored():
    """Return the cases of the stored forms, by form."""
    forms = {}
    for each in stored_rows(FILE, Shown):
        forms.setdefault(each.form, []).append(each)
    return list(forms.values())


def test_a_form_is_repeatable_half_sound_and_holds_no_case_seen_before():
    """Also on a coarse head without landmarks, on which cases are quickly made."""
    egg = CaseMaker(scenario_of("egg"))
    cases = draw_form(egg, np.random.default_rng(1), ())
    assert len({case.seed for case in cases}) == CASES
    assert sum(case.is_sound for case in cases) == CASES // 2
    seen = {case.seed for case in cases[1:]}
    others = draw_form(egg, np.random.default_rng(1), seen)
    assert others[0] == cases[0]
    assert not seen & {case.seed for case in others}


def test_stored_forms_are_half_sound_and_alike_in_difficulty():
    assert len(stored()) == 100
    for form in stored():
        assert [each.number for each in form] == list(range(CASES))
        assert sum(each.is_sound for each in form) == CASES // 2
        mean = np.mean([each.difficulty for each in form])
        assert abs(mean - MEAN_DIFFICULTY) <= DIFFICULTY_SLACK + 1e-3
        assert not any(each.is_sound for each in form if Fault(each.fault) in NEVER_SOUND)


@pytest.mark.parametrize("name", ["residual_mm", "largest_mm", "expected_mm"])
def test_no_stored_form_is_passed_by_a_limit_of_what_is_shown(name):
    for form in stored():
        for limit in [0.0, *(getattr(each, name) for each in form)]:
            refused = [getattr(each, name) > limit for each in form]
            pairs = list(zip(form, refused, strict=True))
            harmful = sum(not each.is_sound and not is_refused for each, is_refused in pairs)
            vain = sum(each.is_sound and is_refused for each, is_refused in pairs)
            assert harmful > MOST_HARMFUL or vain > MOST_VAIN


def test_every_fault_comes_sound_and_unsound_but_what_is_never_sound():
    found = {(each.fault, each.is_sound) for form in stored() for each in form}
    for fault in Fault:
        assert (fault.value, False) in found
        assert ((fault.value, True) in found) == (fault not in NEVER_SOUND)


def test_a_stored_case_is_made_again():
    watcher, row = Watcher(), stored()[3][4]
    again = watcher.shown(3, 4, watcher.maker.case(row.seed, Fault(row.fault)))
    assert again.residual_mm == pytest.approx(row.residual_mm, abs=0.02)
    assert again.offsets == pytest.approx(row.offsets, abs=0.2)
