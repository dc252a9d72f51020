"""In words: what a paired comparison shows, and what so few subjects cannot show."""

from __future__ import annotations

from rastrainer.inference.paired import PairedComparison
from rastrainer.inference.power import ALPHA, TARGET_POWER, detectable_effect, subjects_needed
from rastrainer.number_text import percent, significant

FEW = 20
"""Below this many subjects the limits are said even where nobody asks."""


def what_it_shows(
    name: str, unit: str, first: str, second: str, comparison: PairedComparison, adjusted_p: float
) -> str:
    """Return a sentence that says what the comparison shows, never more.

    Args:
        name: Of the outcome, such as "Completion time".
        unit: Of it, "" where it has none.
        first: Name of the first condition.
        second: Name of the second condition.
        comparison: Second minus first.
        adjusted_p: Its p, adjusted for the number of outcomes.
    """
    low, high = comparison.interval
    difference = comparison.mean_difference
    amount = f"{significant(abs(difference))} {unit}".rstrip()
    ends = [significant(end, sign=True) for end in (low, high)]
    span = f"from {ends[0]} to {ends[1]} {unit}".rstrip()
    direction = "higher" if difference > 0 else "lower"
    if adjusted_p < ALPHA:
        return (
            f"{name} was {amount} {direction} with {second} than with {first} "
            f"(95 % interval {span}); this holds after the correction for several outcomes."
        )
    if comparison.p < ALPHA:
        return (
            f"{name} was {amount} {direction} with {second} than with {first} (95 % interval "
            f"{span}), but this does not hold after the correction for several outcomes."
        )
    return (
        f"{name}: no difference is shown. The data are compatible with anything {span}; that is "
        "not evidence that there is none."
    )


def what_cannot_be_concluded(n: int) -> list[str]:
    """Return what a paired comparison of n subjects cannot tell, in sentences."""
    if n < 2:
        return ["One subject allows no comparison: nothing can be said of anyone else."]
    effect = detectable_effect(n)
    sentences = [
        f"With {n} subjects, a paired t-test at the {percent(ALPHA)} level finds a true difference "
        f"in {percent(TARGET_POWER)} of studies only if it is at least {effect:.1f} times the "
        "standard deviation of the subjects' differences. Smaller ones are mostly missed, and "
        "those found are mostly exaggerated."
    ]
    smallest = 2.0 ** (1 - n)
    if smallest > ALPHA:
        sentences.append(
            f"Wilcoxon's signed-rank test cannot reach the {percent(ALPHA)} level with {n} "
            f"subjects at all: its smallest possible p is {smallest:.3g}."
        )
    if n < FEW:
        needed = {size: subjects_needed(size) for size in (0.2, 0.5, 0.8)}
        sentences += [
            f"To find a small, medium or large effect (d_z of 0.2, 0.5 or 0.8) as reliably, "
            f"{needed[0.2]}, {needed[0.5]} or {needed[0.8]} subjects are needed.",
            "Whether the differences are normally distributed cannot be checked with so few.",
        ]
    sentences.append(
        "Subjects who all did the conditions in the same order show practice and fatigue together "
        "with the difference of the conditions; only a balanced order tells them apart."
    )
    return sentences
