"""The result of a drill of decisions."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.decision.drill_record import DecidedCase
from rastrainer.decision.drill_score import (
    BELIEVER_COST,
    IDEAL_COST,
    MOST_HARMFUL,
    MOST_VAIN,
    DrillScore,
    drill_score,
)
from rastrainer.number_text import clock
from rastrainer_simulator.flow.session.open_pages import PageContent, page_kind
from rastrainer_simulator.flow.session.session import SessionPage
from rastrainer_simulator.presentation.screen import Fact, Tone


@page_kind("drill-result")
def drill_result_page(page: SessionPage, cases: Sequence[DecidedCase]) -> PageContent:
    say, score = page.say, drill_score(cases)
    verdict = "passed" if score.is_passed else "failed"
    title = say(f"drill-result.{verdict}", score=score.score)
    said = say("drill-result.text", harmful=MOST_HARMFUL, vain=MOST_VAIN)
    return PageContent((said,), _facts(page, score), (page.button("back"),), title=title)


def _facts(page: SessionPage, score: DrillScore) -> tuple[Fact, ...]:
    say, texts = page.say, page.session.texts

    def fact(name: str, tone: Tone = Tone.PLAIN, **values: object) -> Fact:
        return Fact(say(f"drill-result.{name}"), say(f"drill-result.{name} value", **values), tone)

    def judged(name: str, count: int, most: int) -> Fact:
        return fact(name, Tone.WARNING if count > most else Tone.GOOD, count=count, most=most)

    missed = texts.listed(
        say("drill-result.missed of", fault=say(f"fault.{fault.value}"), missed=count, cases=total)
        for fault, (count, total) in score.missed.items()
        if count
    )
    interval = score.sensitivity
    return (
        judged("harmful", score.harmful, MOST_HARMFUL),
        judged("vain", score.vain, MOST_VAIN),
        fact("missed", missed=missed or say("drill-result.none")),
        fact("cost", cost=score.mean_cost, ideal=IDEAL_COST, believer=BELIEVER_COST),
        fact("sensitivity", value=interval.value, low=interval.low, high=interval.high),
        fact("confidence", value=score.brier),
        fact("effort", checks=score.mean_checks, time=clock(score.mean_time_s)),
    )
