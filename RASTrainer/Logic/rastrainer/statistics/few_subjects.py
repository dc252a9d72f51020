"""In words: what a paired comparison of few subjects shows and cannot show."""

from __future__ import annotations

from rastrainer.number_text import fixed, p_text, percent, signed
from rastrainer.statistics.intervals import (
    ALPHA,
    TARGET_POWER,
    detectable_effect,
    subjects_needed,
)
from rastrainer.statistics.paired import PairedComparison

FEW_SUBJECTS = 20
"""Below this many subjects the limits are stated without being asked for."""


def what_it_shows(
    name: str,
    unit: str,
    first: str,
    second: str,
    comparison: PairedComparison,
    adjusted_p: float,
    digits: int = 2,
    several: str = "outcomes",
) -> str:
    """Return a sentence that says what the comparison shows, never more.

    Args:
        name: Of the outcome, such as "Completion time".
        unit: Of it, "" where it has none.
        first: Name of the first condition.
        second: Name of the second condition.
        comparison: Second minus first.
        adjusted_p: Its p, adjusted for the number of outcomes.
        digits: After the point, of the difference and its interval.
        several: What p was adjusted for.
    """
    low, high = comparison.interval
    difference = comparison.mean_difference
    amount = f"{fixed(abs(difference), digits)} {unit}".rstrip()
    ends = [signed(end, digits) for end in (low, high)]
    span = f"from {ends[0]} to {ends[1]} {unit}".rstrip()
    direction = "higher" if difference > 0 else "lower"
    if adjusted_p < ALPHA:
        return (
            f"{name} was {amount} {direction} with {second} than with {first} "
            f"(95 % interval {span}); this holds after correction for testing several {several}."
        )
    if comparison.p < ALPHA:
        return (
            f"{name} was {amount} {direction} with {second} than with {first} (95 % interval "
            f"{span}), but this does not hold after correction for testing several {several}."
        )
    return (
        f"{name}: no difference is shown. The data are compatible with anything {span}; that is "
        "not evidence that there is none."
    )


def what_cannot_be_concluded(
    n: int, comparison: PairedComparison | None = None, order_known: bool = True
) -> list[str]:
    """Return what a paired comparison of n subjects cannot show, in sentences.

    Args:
        n: Subjects who did both conditions.
        comparison: Of theirs; None where none could be computed.
        order_known: Whether it is known which condition each subject did first.
    """
    if n < 2:
        return ["One subject allows no comparison: nothing can be said of anyone else."]
    with_period = comparison is not None and comparison.sequences is not None
    effect = detectable_effect(n, with_period=with_period)
    test = "a t-test with the period" if with_period else "a paired t-test"
    sentences = [
        f"With {n} subjects, {test} at the {percent(ALPHA)} level finds a true difference "
        f"in {percent(TARGET_POWER)} of studies only if it is at least {effect:.1f} times the "
        "standard deviation of the subjects' differences. Smaller ones are missed more often, "
        "and where one is found, its size tends to be overestimated."
    ]
    smallest = None
    if comparison is not None and comparison.ranks is not None:
        smallest = comparison.ranks.smallest_p
    if smallest is not None and smallest > ALPHA:
        name = "rank-sum" if with_period else "signed-rank"
        sentences.append(
            f"Wilcoxon's {name} test cannot reach the {percent(ALPHA)} level with {n} "
            f"subjects at all: its smallest possible p is {p_text(smallest)}."
        )
    if n < FEW_SUBJECTS:
        small, medium, large = (
            subjects_needed(size, with_period=with_period) for size in (0.2, 0.5, 0.8)
        )
        sentences += [
            f"To find a small, medium or large effect (d_z of 0.2, 0.5 or 0.8) as reliably, "
            f"{small}, {medium} or {large} subjects are needed.",
            "Whether the differences are normally distributed cannot be checked with so few.",
        ]
    return [*sentences, _about_order(with_period, order_known)]


def _about_order(with_period: bool, order_known: bool) -> str:
    if with_period:
        return (
            "What one condition leaves behind for the next one (carry-over) cannot be separated "
            "from the difference of the conditions where it is not equal in both directions. The "
            "analysis assumes that it is equal; the comparison of the sequences would show only a "
            "large inequality, and finding none proves nothing."
        )
    if not order_known:
        return (
            "Which condition the subjects did first is not in the data: practice and fatigue "
            "cannot be separated from the difference of the conditions, whatever the tests say."
        )
    return (
        "The subjects' orders of the conditions do not allow the effect of the period to be "
        "separated: practice and fatigue are part of the difference of the conditions. Only "
        "different orders, of four subjects or more, separate them."
    )
