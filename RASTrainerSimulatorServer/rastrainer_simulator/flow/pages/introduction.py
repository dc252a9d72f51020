"""Introducing a trainee: sheets of text, the menu over the tutorial, and what comes after it."""

from __future__ import annotations

from rastrainer.protocol import TRIAL_RUN, TutorialRule
from rastrainer_simulator.flow.pages.controls import ControlsPage
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import error_tone
from rastrainer_simulator.flow.session.chosen_trial import (
    may_skip,
    obstacle,
    start_task,
    tutorial_rule,
)
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.presentation.screen import Fact, Menu
from rastrainer_simulator.record.trial_context import TutorialOutcome

SHEETS = 3


class IntroductionPage(SessionPage):
    """A few sheets of text; the last leads to the controls."""

    name = "introduction"
    first = "next"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._sheet = 1

    def menu(self) -> Menu:
        """Return the sheet."""
        return Menu(
            self.name,
            self.say(f"introduction.title.{self._sheet}"),
            (
                self.say(self._text),
                self.say("introduction.sheet", sheet=self._sheet, sheets=SHEETS),
            ),
            items=(self.button("next"), self.button("skip"), self.button("back")),
        )

    @property
    def _text(self) -> str:
        """The key of the sheet's text: 3D Slicer is spoken of only where it is connected."""
        key, alone = f"introduction.text.{self._sheet}", ".alone"
        is_alone = not self.session.is_slicer_connected()
        return f"{key}{alone}" if is_alone and f"{key}{alone}" in self.session.texts else key

    def accept(self, item: str) -> None:
        """Turn the sheet."""
        if item == "back":
            self.back()
        elif item == "next" and self._sheet < SHEETS:
            self._sheet += 1
        else:
            self.session.pages.replace(ControlsPage(self.session, leads_on=True))

    def back(self) -> None:
        """Go back a sheet."""
        if self._sheet == 1:
            self.session.pages.close()
        else:
            self._sheet -= 1


class TutorialPage(SessionPage):
    """Continues the tutorial, restarts it or leaves it."""

    name = "tutorial"

    def menu(self) -> Menu:
        """Return the choices for the tutorial."""
        tutorial = self.session.tutorial
        step, steps = (1, 1) if tutorial is None else tutorial.place
        leave = self.say("tutorial.skip" if self._is_skipped else "tutorial.leave")
        paused = (self.say("tutorial.paused", step=step, steps=steps),)
        return Menu(
            self.name,
            self.session.practice_title,
            () if self._is_practice else paused,
            items=(
                self.button("resume", self.say("trial.resume")),
                self.button("controls"),
                self.button("restart"),
                self.button("leave", leave),
            ),
        )

    def accept(self, item: str) -> None:
        """Do what was chosen."""
        session = self.session
        if item == "resume":
            self.back()
        elif item == "controls":
            session.pages.open(ControlsPage(session))
        elif item == "restart":
            session.restart_practice()
        else:
            if self._is_skipped:
                session.tutorials.skip(session.trainee.strip())
            session.end_tutorial()
            session.pages.show_start()
            session.pages.open(ExperimentPage(session))

    @property
    def _is_practice(self) -> bool:
        tutorial = self.session.tutorial
        return tutorial is not None and bool(tutorial.practiced)

    @property
    def _is_skipped(self) -> bool:
        is_optional = tutorial_rule(self.session) is not TutorialRule.REQUIRED
        return not self._is_practice and (is_optional or may_skip(self.session))

    def pressed(self, control: ControlName) -> bool:
        """The control that pauses also resumes."""
        if control is ControlName.PAUSE:
            self.back()
        return control is ControlName.PAUSE


class TutorialDonePage(SessionPage):
    """Says how exact the touches were, and leads to the trial run."""

    name = "tutorial-done"

    def __init__(self, session: TrainingSession, outcome: TutorialOutcome) -> None:
        super().__init__(session)
        self._outcome = outcome

    def menu(self) -> Menu:
        """Return the figures and what comes next."""
        outcome = self._outcome
        errors = (self.say("tutorial.mm", error=error) for error in outcome.errors_mm)
        touches = self.session.texts.listed(errors)
        reason = obstacle(self.session, TRIAL_RUN)
        trial_run = self.button("trial-run", is_enabled=not reason, help=reason)
        return Menu(
            self.name,
            self.say("tutorial-done.title"),
            (self.say("tutorial-done.text", trainee=outcome.trainee),),
            (
                Fact(self.say("tutorial-done.time"), self.session.duration(outcome.duration_s)),
                Fact(
                    self.say("tutorial-done.first"),
                    self.say("tutorial.mm", error=outcome.first_error_mm),
                ),
                Fact(self.say("tutorial-done.touches"), touches),
            ),
            items=(trial_run, self.button("again"), self.button("menu")),
        )

    def accept(self, item: str) -> None:
        """Begin the trial run, do the tutorial again, or go to the menu."""
        if item == "trial-run":
            start_task(self.session, TRIAL_RUN)
        elif item == "again":
            self.session.begin_tutorial()
        else:
            self.back()


class PracticedPage(SessionPage):
    """Says how exact the touch of a practiced point was, and offers another one."""

    name = "practiced"

    def __init__(self, session: TrainingSession, outcome: TutorialOutcome) -> None:
        super().__init__(session)
        self._title, self._error_mm = session.practice_title, outcome.errors_mm[-1]

    def menu(self) -> Menu:
        """Return the error and what comes next."""
        error = self.say("tutorial.mm", error=self._error_mm)
        facts = (Fact(self.say("practiced.error"), error, error_tone(self._error_mm)),)
        items = (self.button("again"), self.button("menu", self.say("tutorial-done.menu")))
        return Menu(self.name, self._title, (), facts, items)

    def accept(self, item: str) -> None:
        """Practice the point again, or go to the menu."""
        if item == "again":
            self.session.restart_practice()
        else:
            self.back()
