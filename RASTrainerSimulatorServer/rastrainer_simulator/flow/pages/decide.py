"""The beginning of a drill of decisions, and its explanation."""

from __future__ import annotations

from rastrainer.decision.drill_record import CASE_S, CHECK_S
from rastrainer.decision.drill_score import (
    AGAIN_COST,
    CHECK_COST,
    HARM_COST,
    STOP_COST,
    VAIN_COST,
)
from rastrainer_simulator.flow.pages.case import case_page, truth_page
from rastrainer_simulator.flow.session import chosen_trial
from rastrainer_simulator.flow.session.open_pages import PageContent, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
from rastrainer_simulator.presentation.screen import Fact


def open_drill(session: TrainingSession) -> None:
    """Continue the trainee's drill or begin one; the first is explained before it begins."""
    if session.has_open_drill or session.history.drills(session.trainee_id):
        _go_to_case(session)
    else:
        session.pages.open(introduction_page(session))


def _go_to_case(session: TrainingSession) -> None:
    session.begin_drill()
    drill = session.drill
    if drill is not None:
        session.view.close()
        session.view.control.reset()
        page = case_page if drill.decided is None else truth_page
        session.pages.show(page(session), ignore_input_briefly=True)


@page_kind("decide-introduction")
def introduction_page(page: SessionPage) -> PageContent:
    """Explain cases, checks and the cost of decisions."""
    session, say = page.session, page.say
    costs = {
        "harm": HARM_COST,
        "stop": STOP_COST,
        "vain": AGAIN_COST + VAIN_COST,
        "again": AGAIN_COST,
        "check": CHECK_COST,
    }
    facts = (
        Fact(say(f"decide-introduction.{name}"), say("case.cost", cost=cost))
        for name, cost in costs.items()
    )
    reason = chosen_trial.drill_obstacle(session)
    begin = page.button("begin", lambda: _go_to_case(session), is_enabled=not reason, help=reason)
    said = (
        say("decide-introduction.case"),
        say("decide-introduction.checks", minutes=CASE_S / 60.0, seconds=CHECK_S),
        say("decide-introduction.costs"),
    )
    return PageContent(said, tuple(facts), (begin, page.button("back")), first="begin")
