"""The tables of Testing/error_rates/tables.md."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from Testing.error_rates import (
    agreement,
    biased_aim,
    cheats,
    cohort,
    compared_methods,
    curricula,
    decision_rates,
    drawn_traces,
    drills,
    equal_hands,
    groups,
    learning,
    match_warnings,
    method_errors,
    modes,
    propagation,
    recovery,
    target_errors,
    virtual_hand,
)
from Testing.error_rates.measured import Measured

PAGE = Path(__file__).with_name("tables.md")
SETS = 2000
TABLES: dict[str, tuple[Sequence[str], Callable[[int], Sequence[Measured]]]] = {
    "learning": (learning.HEADER, learning.series),
    "cohorts": (learning.COHORT_HEADER, learning.cohorts),
    "null cohorts": (learning.NULL_HEADER, learning.null_cohorts),
    "groups": (groups.HEADER, groups.one_population),
    "several groups": (groups.POWER_HEADER, groups.several_populations),
    "sequences": (modes.HEADER, modes.sequences),
    "studies": (modes.STUDY_HEADER, modes.studies),
    "compared methods": (compared_methods.HEADER, compared_methods.differences),
    "effect sizes": (modes.EFFECT_HEADER, modes.coverage),
    "recovery": (recovery.HEADER, recovery.parameters),
    "recovery intervals": (recovery.COVERAGE_HEADER, recovery.coverage),
    "agreement": (agreement.HEADER, agreement.intervals),
    "played cohort": (cohort.HEADER, cohort.recovered),
    "throughput": (cheats.THROUGHPUT_HEADER, cheats.offsets),
    "aborted trials": (cheats.ABORTED_HEADER, cheats.competence),
    "goals": (curricula.GOALS_HEADER, curricula.goals),
    "next task": (curricula.CHOICES_HEADER, curricula.choices),
    "target errors": (target_errors.HEADER, target_errors.intervals),
    "propagation": (propagation.HEADER, propagation.targets),
    "methods": (method_errors.HEADER, method_errors.measured),
    "match warnings": (match_warnings.HEADER, match_warnings.measured),
    "drawn traces": (drawn_traces.HEADER, drawn_traces.measured),
    "virtual hand": (virtual_hand.HEADER, virtual_hand.quantities),
    "cheats": (cheats.HEADER, cheats.played),
    "biased aim": (biased_aim.HEADER, biased_aim.scores),
    "drill learning": (drills.LEARNING_HEADER, drills.learning),
    "drill training": (drills.TRAINING_HEADER, drills.training),
    "drill means": (drills.MEAN_HEADER, drills.means),
    "drill misses": (drills.MISSED_HEADER, drills.missed_most),
    "observers": (decision_rates.OBSERVERS_HEADER, decision_rates.observers),
    "faults": (decision_rates.FAULTS_HEADER, decision_rates.by_fault),
    "drill cheats": (decision_rates.CHEATS_HEADER, decision_rates.cheats),
    "drill passing": (decision_rates.PASSING_HEADER, decision_rates.passing),
    "drill scores": (decision_rates.SCORES_HEADER, decision_rates.scores),
    "drill abilities": (decision_rates.ABILITY_HEADER, decision_rates.abilities),
    "drill difficulties": (decision_rates.DIFFICULTY_HEADER, decision_rates.difficulties),
    "equal hands": (equal_hands.HEADER, equal_hands.usual),
    "slow hands": (equal_hands.HEADER, equal_hands.slow),
}


def printed(name: str, text: str) -> str:
    """Return the table with this name from the text of a page."""
    return _place(name).search(text)[2].strip()


def with_table(name: str, text: str, table: str) -> str:
    """Return the text with the table of this name replaced."""
    replaced, places = _place(name).subn(lambda found: f"{found[1]}{table}\n{found[3]}", text)
    if places != 1:
        raise ValueError(f"The page must have one place for the table {name!r}, not {places}.")
    return replaced


def _place(name: str) -> re.Pattern[str]:
    return re.compile(rf"(<!-- {name} -->\n)(.*?)(<!-- end -->)", re.DOTALL)
