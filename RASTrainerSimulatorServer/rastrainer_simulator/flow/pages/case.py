"""The drill of decisions: explanation, figures, checks, images and truth of a case, result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from rastrainer import transforms
from rastrainer.decision import drill_score
from rastrainer.decision.drill_record import (
    CASE_S,
    CHECK_S,
    CONFIDENCES,
    FAULTS,
    DecidedCase,
    Decision,
    Fault,
)
from rastrainer.number_text import clock
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.decision.drill import TIP, Drill
from rastrainer_simulator.flow.session import chosen_trial
from rastrainer_simulator.flow.session.head_slices import head_slices
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
from rastrainer_simulator.presentation.screen import Fact, SliceMark, Tone

TARGET = "target"
_POINT = "point "
"""No place's name begins like this: no place is mistaken for "back"."""
FIDUCIAL = "fiducial "


def drill_of(session: TrainingSession) -> Drill:
    assert session.drill is not None, "Its pages are open while there is a drill."
    return session.drill


def place_name(session: TrainingSession, place: str) -> str:
    """Return the name of a place in the trainee's language, as far as it is a usual one."""
    if place.startswith(FIDUCIAL):
        return session.say("place.fiducial", label=place.removeprefix(FIDUCIAL))
    key = f"place.{place}"
    return session.say(key) if key in session.texts else place


def open_drill(session: TrainingSession) -> None:
    """Continue the trainee's drill or begin one; the first is explained before it begins."""
    if session.open_drill is not None or session.history.drills(session.trainee_id):
        go_to_case(session)
    else:
        session.pages.open(introduction_page(session))


def go_to_case(session: TrainingSession) -> None:
    session.begin_drill()
    if session.drill is not None:
        session.view.close()
        session.view.control.reset()
        session.pages.show(case_page(session), ignore_input_briefly=True)


@page_kind("decide-introduction")
def introduction_page(page: SessionPage) -> PageContent:
    """Explain cases, checks and the cost of decisions."""
    session, say = page.session, page.say
    costs = {
        "harm": drill_score.HARM_COST,
        "stop": drill_score.STOP_COST,
        "vain": drill_score.AGAIN_COST + drill_score.VAIN_COST,
        "again": drill_score.AGAIN_COST,
        "check": drill_score.CHECK_COST,
    }
    facts = [
        Fact(say(f"decide-introduction.{name}"), say("case.cost", cost=cost))
        for name, cost in costs.items()
    ]
    reason = chosen_trial.drill_obstacle(session)
    begin = page.button("begin", lambda: go_to_case(session), is_enabled=not reason, help=reason)
    said = (
        say("decide-introduction.case"),
        say("decide-introduction.checks", minutes=CASE_S / 60.0, seconds=CHECK_S),
        say("decide-introduction.costs"),
    )
    return PageContent(said, facts, (begin, page.button("back")), first="begin")


def _look(page: SessionPage) -> None:
    drill = drill_of(page.session)
    if drill.is_ready and drill.left_s > 0.0:
        page.session.pages.show(None)


def leave_drill(session: TrainingSession) -> None:
    session.leave_drill()
    session.pages.show_start()


@page_kind("case-leave")
def leave_page(page: SessionPage) -> PageContent:
    """Ask whether to leave the drill, which is kept."""
    rows = (page.button("stay"), page.button("leave", partial(leave_drill, page.session)))
    return PageContent((page.say("case-leave.text"),), rows=rows, first="stay")


@page_kind("case", back=_look, pause_goes_back=True)
def case_page(page: SessionPage) -> PageContent:
    """Show the figures that a surgeon has of a registration, and the actions."""
    session, say, drill = page.session, page.say, drill_of(page.session)
    title = say("case.title", number=drill.number, count=drill.count)
    leave = page.button("leave", page.open_page(leave_page))
    if not drill.is_ready or drill.decided is not None:
        return PageContent((say("case.preparing"),), rows=(leave,), title=title, first="look")
    case, late = drill.case, "" if drill.left_s > 0.0 else say("case.late")

    def row(name: str, accept: Callable[[], object], value: str = "") -> PageRow:
        help_ = late or say(f"case.{name} help", seconds=CHECK_S)
        return page.button(name, accept, value=value, is_enabled=not late, help=help_)

    low, high = case.expected.interval_mm
    # No-break spaces: no point is on another line than its number.
    each = (
        f"{place_name(session, label)}\N{NO-BREAK SPACE}{say('case.number', value=residual)}"
        for label, residual in zip(case.labels, case.residuals_mm, strict=True)
    )
    facts = (
        Fact(say("experiment.method"), say(f"method.{case.method.value}")),
        Fact(say("case.residuals"), session.texts.listed(each)),
        Fact(say("case.residual"), say("result.mm", error=case.residual_mm)),
        Fact(
            say("case.expected"),
            say("case.interval", error=case.expected.expected_mm, low=low, high=high),
        ),
        Fact(say("case.limit"), say("result.mm", error=case.limit_mm)),
    )
    rows = (
        row("look", partial(_look, page)),
        row("check", page.open_page(places_page), str(len(drill.checks) or "")),
        row("images", partial(_read_images, session)),
        page.button("decide", page.open_page(decision_page)),
        leave,
    )
    first = "decide" if late else "look"
    return PageContent((say("case.text"),), facts, rows, title=title, first=first)


@page_kind("case-places")
def places_page(page: SessionPage) -> PageContent:
    """List what can be checked; the arm goes there, and the pages close."""
    session, drill = page.session, drill_of(page.session)

    def check(place: str) -> None:
        with session.complaining():
            drill.check(place, lambda: session.pages.show(None))

    def row(place: str) -> PageRow:
        value = page.say("case-places.checked") if place in drill.checks else ""
        name, go = place_name(session, place), partial(check, place)
        return page.button(_POINT + place, go, name, value=value)

    tip = page.button(TIP, partial(check_tip, session))
    rows = (*map(row, drill.case.places), tip, page.button("back"))
    return PageContent((page.say("case-places.text", seconds=CHECK_S),), rows=rows)


def check_tip(session: TrainingSession) -> None:
    """Show where the registration puts the tip in the images."""

    def show() -> None:
        tip = session.placed_case.in_images(MM_PER_M * np.array(session.state.tip))
        session.pages.show(case_page(session))
        session.pages.open(images_page(session, tip, through=TIP))

    with session.complaining():
        drill_of(session).check(TIP, show)


def _read_images(session: TrainingSession) -> None:
    with session.complaining():
        drill_of(session).read_images(lambda: session.pages.open(images_page(session, None)))


@page_kind("case-images")
def images_page(page: SessionPage, tip: np.ndarray | None, through: str = TARGET) -> PageContent:
    """Show three slices of the images through the target, a registered point or the tip."""
    session, case = page.session, drill_of(page.session).case
    places = {TARGET: case.target_mm, **({} if tip is None else {TIP: tip})}
    marked = {SliceMark(name): place for name, place in places.items()}
    places |= {_POINT + label: at for label, at in zip(case.labels, case.fixed_mm, strict=True)}
    label = through.removeprefix(_POINT)
    name = place_name(session, label)
    if through in (TARGET, TIP):
        name = page.say(f"slices.{through}")
    choice = page.choice("through", tuple(places), through, name)
    slices = head_slices(session.texts, case, places[through], marked, name)
    return PageContent(rows=(choice, page.button("back")), slices=slices, first="through")


@page_kind("case-decision")
def decision_page(page: SessionPage) -> PageContent:
    """Ask what to do with the registration; everything can be taken back until the last press."""
    rows = [
        page.button(
            each.value,
            page.open_page(confidence_page, each),
            help=page.say(f"case-decision.{each.value} help"),
        )
        for each in Decision
    ]
    is_late = drill_of(page.session).left_s <= 0.0
    said = (*([page.say("case.late")] if is_late else ()), page.say("case-decision.text"))
    return PageContent(said, rows=(*rows, page.button("back")))


@page_kind("case-confidence")
def confidence_page(page: SessionPage, decision: Decision) -> PageContent:
    is_last = decision is Decision.PROCEED
    rows = []
    for each in CONFIDENCES:
        go_on = page.open_page(suspect_page, decision, each)
        if is_last:
            go_on = partial(_decide, page.session, decision, each, None)
        rows.append(page.button(f"{each}", go_on, page.say("case-confidence.share", share=each)))
    title = page.say(f"case-decision.{decision.value}")
    said = (page.say("case-confidence.text"), *([page.say("case.last")] if is_last else ()))
    return PageContent(said, rows=(*rows, page.button("back")), title=title)


@page_kind("case-suspect")
def suspect_page(page: SessionPage, decision: Decision, confidence: int) -> PageContent:
    rows = [
        page.button(
            fault.value,
            partial(_decide, page.session, decision, confidence, fault),
            page.say(f"fault.{fault.value}"),
        )
        for fault in (*FAULTS, Fault.NONE)
    ]
    return PageContent((page.say("case.last"),), rows=(*rows, page.button("back")))


def _decide(
    session: TrainingSession, decision: Decision, confidence: int, suspected: Fault | None
) -> None:
    with session.complaining():
        drill_of(session).decide(decision, confidence, suspected)


@page_kind("case-truth", back=lambda page: page.open_page(leave_page)())
def truth_page(page: SessionPage) -> PageContent:
    """Tell the truth about a decided case: its error, the cause and what would have shown it."""
    session, say, drill = page.session, page.say, drill_of(page.session)
    decided, case = drill.decided, drill.case
    assert decided is not None, "The truth is told once the case is decided."
    sound = "sound" if decided.is_sound else "harmful"
    error = say("case-truth.error of", error=case.true_error_mm, limit=case.limit_mm)
    decision = say(f"case-decision.{decided.decision.value}")
    sure = say("case-truth.sure", decision=decision, share=decided.confidence)
    facts = [
        Fact(say("case-truth.decision"), sure, _tone(decided.is_right)),
        Fact(say("case-truth.error"), error, _tone(decided.is_sound)),
        Fact(say("case-truth.cause"), say(f"fault.{decided.fault.value}")),
    ]
    if suspected := decided.suspected:
        tone, named = _tone(suspected is decided.fault), say(f"fault.{suspected.value}")
        facts.append(Fact(say("case-truth.suspected"), named, tone))
    to_images = case.images @ transforms.inverse(case.head_to_world)
    reached = transforms.apply(to_images, case.tip_for(case.target_mm))
    places = {SliceMark.TARGET: case.target_mm, SliceMark.REACHED: reached}
    name = say("slices.target")
    slices = head_slices(session.texts, case, case.target_mm, places, name)
    onward = page.button("next", partial(_go_on, session))
    if drill.is_over:
        onward = page.button("result", partial(_end, session), is_enabled=drill.is_finished)
    rows = (onward, page.button("leave", page.back, say("case.leave")))
    title = say(f"case-truth.{'right' if decided.is_right else 'wrong'} {sound}")
    said = (say(f"shown.{decided.fault.value}"),)
    return PageContent(said, facts, rows, title=title, slices=slices)


def _tone(is_good: bool) -> Tone:
    return Tone.GOOD if is_good else Tone.ERROR


def _go_on(session: TrainingSession) -> None:
    drill_of(session).next_case()
    session.pages.show(case_page(session))


def _end(session: TrainingSession) -> None:
    cases = drill_of(session).cases
    leave_drill(session)
    session.pages.open(drill_result_page(session, cases))


@page_kind("drill-result")
def drill_result_page(page: SessionPage, cases: Sequence[DecidedCase]) -> PageContent:
    say, score = page.say, drill_score.drill_score(cases)

    def fact(name: str, tone: Tone = Tone.PLAIN, **values: object) -> Fact:
        return Fact(say(f"drill-result.{name}"), say(f"drill-result.{name} value", **values), tone)

    def judged(name: str, count: int, most: int) -> Fact:
        return fact(name, Tone.WARNING if count > most else Tone.GOOD, count=count, most=most)

    missed = page.session.texts.listed(
        say("drill-result.missed of", fault=say(f"fault.{fault.value}"), missed=count, cases=total)
        for fault, (count, total) in score.missed.items()
        if count
    )
    most = {"harmful": drill_score.MOST_HARMFUL, "vain": drill_score.MOST_VAIN}
    ideal, believer = drill_score.IDEAL_COST, drill_score.BELIEVER_COST
    low, high = score.sensitivity.interval
    facts = (
        judged("harmful", score.harmful, most["harmful"]),
        judged("vain", score.vain, most["vain"]),
        fact("missed", missed=missed or say("drill-result.none")),
        fact("cost", cost=score.mean_cost, ideal=ideal, believer=believer),
        fact("sensitivity", value=score.sensitivity.value, low=low, high=high),
        fact("confidence", value=score.brier),
        fact("effort", checks=score.mean_checks, time=clock(score.mean_time_s)),
    )
    verdict = "passed" if score.is_passed else "failed"
    title = say(f"drill-result.{verdict}", score=score.score)
    said = say("drill-result.text", **most)
    return PageContent((said,), facts, (page.button("back"),), title=title)
