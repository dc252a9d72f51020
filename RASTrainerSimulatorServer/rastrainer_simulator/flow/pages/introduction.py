"""Introducing a trainee: sheets of text, the menu during the tutorial, and the pages after it."""

from __future__ import annotations

from functools import partial

from rastrainer.number_text import clock
from rastrainer.protocol import TRIAL_RUN, TutorialRule
from rastrainer_simulator.flow.pages.controls import controls_page
from rastrainer_simulator.flow.pages.experiment import open_experiment
from rastrainer_simulator.flow.pages.trial_review import error_tone
from rastrainer_simulator.flow.session import chosen_trial
from rastrainer_simulator.flow.session.open_pages import PageContent, page_kind
from rastrainer_simulator.flow.session.session import SessionPage
from rastrainer_simulator.presentation.screen import Fact
from rastrainer_simulator.record.trial_context import TutorialOutcome

SHEETS = 3


def _leave_sheet(page: SessionPage, sheet: int = 1) -> None:
    if sheet == 1:
        page.session.pages.close()
    else:
        page.set_value("sheet", sheet - 1)


@page_kind("introduction", back=_leave_sheet)
def introduction_page(page: SessionPage, sheet: int = 1) -> PageContent:
    """Show one of a few sheets of text; the last leads to the controls."""
    session = page.session
    key, alone = f"introduction.text.{sheet}", f"introduction.text.{sheet}.alone"
    # Mention 3D Slicer only if it is connected.
    if not session.services.is_slicer_connected() and alone in session.texts:
        key = alone
    skip = partial(session.pages.replace, controls_page(session, True))
    turn = partial(page.set_value, "sheet", sheet + 1)
    rows = (
        page.button("next", turn if sheet < SHEETS else skip),
        page.button("skip", skip),
        page.button("back"),
    )
    place = page.say("introduction.sheet", sheet=sheet, sheets=SHEETS)
    title = page.say(f"introduction.title.{sheet}")
    return PageContent((page.say(key), place), rows=rows, title=title, first="next")


@page_kind("tutorial", pause_goes_back=True)
def tutorial_page(page: SessionPage) -> PageContent:
    session, say = page.session, page.say
    tutorial = session.tutorial
    step, steps = (1, 1) if tutorial is None else tutorial.place
    is_practice = tutorial is not None and bool(tutorial.practiced)
    is_optional = chosen_trial.tutorial_rule(session) is not TutorialRule.REQUIRED
    is_skipped = not is_practice and (is_optional or chosen_trial.may_skip(session))

    def leave() -> None:
        if is_skipped:
            session.history.skipped.add((session.trainee_id, ""))
        session.end_tutorial()
        open_experiment(session)

    paused = say("tutorial.paused", step=step, steps=steps)
    rows = (
        page.button("resume", label=say("trial.resume")),
        page.button("controls", page.open_page(controls_page)),
        page.button("restart", partial(session.begin_tutorial, *session.practiced)),
        page.button("leave", leave, say("tutorial.skip" if is_skipped else "tutorial.leave")),
    )
    said = () if is_practice else (paused,)
    return PageContent(said, rows=rows, title=session.practice_title)


@page_kind("tutorial-done")
def tutorial_done_page(page: SessionPage, outcome: TutorialOutcome) -> PageContent:
    session, say = page.session, page.say
    errors = (say("tutorial.mm", error=error) for error in outcome.errors_mm)
    facts = (
        Fact(say("tutorial-done.time"), clock(outcome.duration_s)),
        Fact(say("tutorial-done.first"), say("tutorial.mm", error=outcome.first_error_mm)),
        Fact(say("tutorial-done.touches"), session.texts.listed(errors)),
    )
    reason = chosen_trial.obstacle(session, TRIAL_RUN)
    start = partial(chosen_trial.start_task, session, TRIAL_RUN)
    rows = (
        page.button("trial-run", start, is_enabled=not reason, help=reason),
        page.button("again", session.begin_tutorial),
        page.button("menu"),
    )
    return PageContent((say("tutorial-done.text", trainee=outcome.trainee),), facts, rows)


@page_kind("practiced")
def practiced_page(page: SessionPage, outcome: TutorialOutcome) -> PageContent:
    session, error_mm = page.session, outcome.errors_mm[-1]
    error = page.say("tutorial.mm", error=error_mm)
    fact = Fact(page.say("practiced.error"), error, error_tone(error_mm))
    rows = (
        page.button("again", partial(session.begin_tutorial, *session.practiced)),
        page.button("menu", label=page.say("tutorial-done.menu")),
    )
    return PageContent((), (fact,), rows, title=session.practice_title)
