"""Introducing a trainee: sheets of text, the menu during the tutorial, and the pages after it."""

from __future__ import annotations

from functools import partial

from rastrainer.number_text import clock
from rastrainer.protocol import TRIAL_RUN, TutorialRule
from rastrainer_simulator.flow.pages.controls import controls_page
from rastrainer_simulator.flow.pages.experiment import open_experiment
from rastrainer_simulator.flow.pages.session_page import SessionPage, page_kind
from rastrainer_simulator.flow.pages.trial_review import error_tone
from rastrainer_simulator.flow.session.chosen_trial import (
    may_skip,
    obstacle,
    start_task,
    tutorial_rule,
)
from rastrainer_simulator.flow.session.open_pages import PageContent
from rastrainer_simulator.presentation.screen import Fact
from rastrainer_simulator.record.trial_context import TutorialOutcome

SHEETS = 3


class IntroductionPage(SessionPage):
    """A few sheets of text; the last leads to the controls."""

    name = "introduction"
    _sheet = 1

    def content(self) -> PageContent:
        key, alone = f"introduction.text.{self._sheet}", ".alone"
        # Mention 3D Slicer only if it is connected.
        is_alone = not self.session.services.is_slicer_connected()
        if is_alone and f"{key}{alone}" in self.session.texts:
            key += alone
        place = self.say("introduction.sheet", sheet=self._sheet, sheets=SHEETS)
        rows = (
            self.button("next", self._turn),
            self.button("skip", self._leave),
            self.button("back"),
        )
        title = self.say(f"introduction.title.{self._sheet}")
        return PageContent(title, (self.say(key), place), rows=rows, first="next")

    def back(self) -> None:
        if self._sheet == 1:
            self.session.pages.close()
        else:
            self._sheet -= 1

    def _turn(self) -> None:
        if self._sheet < SHEETS:
            self._sheet += 1
        else:
            self._leave()

    def _leave(self) -> None:
        self.session.pages.replace(controls_page(self.session, True))


@page_kind("tutorial", pause_goes_back=True)
def tutorial_page(page: SessionPage) -> PageContent:
    """Offer to continue the tutorial, to restart it or to leave it."""
    session, say = page.session, page.say
    tutorial = session.tutorial
    step, steps = (1, 1) if tutorial is None else tutorial.place
    is_practice = tutorial is not None and bool(tutorial.practiced)
    is_optional = tutorial_rule(session) is not TutorialRule.REQUIRED
    is_skipped = not is_practice and (is_optional or may_skip(session))

    def leave() -> None:
        if is_skipped:
            session.history.skipped_tutorials.add(session.trainee_id)
        session.end_tutorial()
        open_experiment(session)

    paused = say("tutorial.paused", step=step, steps=steps)
    rows = (
        page.button("resume", label=say("trial.resume")),
        page.button("controls", page.open_page(controls_page)),
        page.button("restart", partial(session.begin_tutorial, *session.practiced)),
        page.button("leave", leave, say("tutorial.skip" if is_skipped else "tutorial.leave")),
    )
    return PageContent(session.practice_title, () if is_practice else (paused,), rows=rows)


@page_kind("tutorial-done")
def tutorial_done_page(page: SessionPage, outcome: TutorialOutcome) -> PageContent:
    """Say how exact the touches were, and lead to the trial run."""
    session, say = page.session, page.say
    errors = (say("tutorial.mm", error=error) for error in outcome.errors_mm)
    facts = (
        Fact(say("tutorial-done.time"), clock(outcome.duration_s)),
        Fact(say("tutorial-done.first"), say("tutorial.mm", error=outcome.first_error_mm)),
        Fact(say("tutorial-done.touches"), session.texts.listed(errors)),
    )
    reason = obstacle(session, TRIAL_RUN)
    start = partial(start_task, session, TRIAL_RUN)
    rows = (
        page.button("trial-run", start, is_enabled=not reason, help=reason),
        page.button("again", session.begin_tutorial),
        page.button("menu"),
    )
    text = say("tutorial-done.text", trainee=outcome.trainee)
    return PageContent(say("tutorial-done.title"), (text,), facts, rows)


@page_kind("practiced")
def practiced_page(page: SessionPage, outcome: TutorialOutcome) -> PageContent:
    """Say how exact the touch of a practiced point was, and offer another one."""
    session, error_mm = page.session, outcome.errors_mm[-1]
    error = page.say("tutorial.mm", error=error_mm)
    fact = Fact(page.say("practiced.error"), error, error_tone(error_mm))
    rows = (
        page.button("again", partial(session.begin_tutorial, *session.practiced)),
        page.button("menu", label=page.say("tutorial-done.menu")),
    )
    return PageContent(session.practice_title, (), (fact,), rows)
