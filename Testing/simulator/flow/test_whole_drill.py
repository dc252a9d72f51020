"""A drill of twenty cases of a drawn form, played whole by keys."""

from __future__ import annotations

import pytest

from rastrainer.decision.drill_record import CASES
from rastrainer.decision.drill_score import drill_score

ARRIVED = "By the registration", "Look at the head"
"""Instructions once the arm is at a place, or was steered away."""


@pytest.mark.soak
def test_twenty_cases_are_checked_decided_scored_and_delivered(trainee, loop):
    trainee.choose("decide", "decide")
    trainee.choose("begin", "decide-introduction")
    trainee.choose("begin")
    for number in range(1, CASES + 1):
        title = f"Case {number} of {CASES}"

        def is_shown(title=title) -> bool:
            return trainee.menu.title == title and bool(trainee.menu.facts)

        trainee.until(is_shown, title)
        trainee.choose("check", "case-places")
        trainee.choose("point Nasion", None)
        trainee.until(lambda: trainee.presenter.screen.instruction.text.startswith(ARRIVED), title)
        trainee.tap_until("menu", "case")
        trainee.choose("images", "case-images")
        trainee.choose("back", "case")
        for item, menu in (
            ("decide", "case-decision"),
            ("register again", "case-confidence"),
            ("50", "case-suspect"),
            ("none", "case-truth"),
        ):
            trainee.choose(item, menu)
        if number < CASES:
            trainee.choose("next")
    trainee.until(lambda: trainee.item("result").is_enabled, "the record")
    trainee.choose("result", "drill-result")
    assert trainee.menu.title.startswith("Not passed"), "always registering again never passes"
    trainee.until(lambda: loop.archive.unacknowledged(), "the delivery")
    (record,) = loop.archive.unacknowledged()
    assert len({case.seed for case in record.cases}) == CASES
    assert all(case.checks == ("Nasion",) and case.has_read_images for case in record.cases)
    score = drill_score(record.cases)
    assert (score.harmful, score.vain) == (0, CASES // 2)
