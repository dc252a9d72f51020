"""Introducing a trainee: sheets of text, the menu during the tutorial, and the pages after it."""

from __future__ import annotations

from functools import partial

from rastrainer.protocol import TRIAL_RUN, TutorialRule
from rastrainer_simulator.flow.pages.controls import ControlsPage
from rastrainer_simulator.flow.pages.experiment import open_experiment
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import error_tone
from rastrainer_simulator.flow.session.chosen_trial import (
    may_skip,
    obstacle,
    start_task,
    tutorial_rule,
)
from rastrainer_simulator.flow.session.open_pages import PageContent
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.presentation.screen import Fact
from rastrainer_simulator.record.trial_context import TutorialOutcome

SHEETS = 3


class IntroductionPage(SessionPage):
    """A few sheets of text; the last leads to the controls."""

    name = "introduction"
    first = "next"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._sheet = 1

    def content(self) -> PageContent:
        key, alone = f"introduction.text.{self._sheet}", ".alone"
        # Mention 3D Slicer only if it is connected.
        if not self.session.is_slicer_connected() and f"{key}{alone}" in self.session.texts:
            key += alone
        place = self.say("introduction.sheet", sheet=self._sheet, sheets=SHEETS)
        rows = (
            self.button("next", self._turn),
            self.button("skip", self._leave),
            self.button("back"),
        )
        title = self.say(f"introduction.title.{self._sheet}")
        return PageContent(title, (self.say(key), place), rows=rows)

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
        self.session.pages.replace(ControlsPage(self.session, leads_on=True))


class TutorialPage(SessionPage):
    """Continues the tutorial, restarts it or leaves it."""

    name = "tutorial"
    pause_goes_back = True

    def content(self) -> PageContent:
        session = self.session
        tutorial = session.tutorial
        step, steps = (1, 1) if tutorial is None else tutorial.place
        is_practice = tutorial is not None and bool(tutorial.practiced)
        is_optional = tutorial_rule(session) is not TutorialRule.REQUIRED
        is_skipped = not is_practice and (is_optional or may_skip(session))
        leave = self.say("tutorial.skip" if is_skipped else "tutorial.leave")
        paused = self.say("tutorial.paused", step=step, steps=steps)
        rows = (
            self.button("resume", label=self.say("trial.resume")),
            self.button("controls", self.open_page(ControlsPage)),
            self.button("restart", session.restart_practice),
            self.button("leave", lambda: self._leave(is_skipped), leave),
        )
        return PageContent(session.practice_title, () if is_practice else (paused,), rows=rows)

    def _leave(self, is_skipped: bool) -> None:
        session = self.session
        if is_skipped:
            session.tutorials.skip(session.trainee_id)
        session.end_tutorial()
        open_experiment(session)


class TutorialDonePage(SessionPage):
    """Says how exact the touches were, and leads to the trial run."""

    name = "tutorial-done"

    def __init__(self, session: TrainingSession, outcome: TutorialOutcome) -> None:
        super().__init__(session)
        self._outcome = outcome

    def content(self) -> PageContent:
        session, outcome = self.session, self._outcome
        first = self.say("tutorial.mm", error=outcome.first_error_mm)
        errors = (self.say("tutorial.mm", error=error) for error in outcome.errors_mm)
        facts = (
            Fact(self.say("tutorial-done.time"), session.duration(outcome.duration_s)),
            Fact(self.say("tutorial-done.first"), first),
            Fact(self.say("tutorial-done.touches"), session.texts.listed(errors)),
        )
        reason = obstacle(session, TRIAL_RUN)
        start = partial(start_task, session, TRIAL_RUN)
        rows = (
            self.button("trial-run", start, is_enabled=not reason, help=reason),
            self.button("again", session.begin_tutorial),
            self.button("menu"),
        )
        text = self.say("tutorial-done.text", trainee=outcome.trainee)
        return PageContent(self.say("tutorial-done.title"), (text,), facts, rows)


class PracticedPage(SessionPage):
    """Says how exact the touch of a practiced point was, and offers another one."""

    name = "practiced"

    def __init__(self, session: TrainingSession, outcome: TutorialOutcome) -> None:
        super().__init__(session)
        self._title, self._error_mm = session.practice_title, outcome.errors_mm[-1]

    def content(self) -> PageContent:
        error = self.say("tutorial.mm", error=self._error_mm)
        fact = Fact(self.say("practiced.error"), error, error_tone(self._error_mm))
        rows = (
            self.button("again", self.session.restart_practice),
            self.button("menu", label=self.say("tutorial-done.menu")),
        )
        return PageContent(self._title, (), (fact,), rows)
