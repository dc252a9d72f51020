"""The page on which a trainee accepts the match of a trace, or draws on.

A small residual does not mean a small error: both are shown, and what looks wrong with the match.
"""

from __future__ import annotations

from concurrent.futures import Future

from rastrainer.errors import RASTrainerError
from rastrainer.protocol import CommandName
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.match_report import MatchReport
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.net.views.screen import Fact, Menu, Tone


class MatchPage(SessionPage):
    """Tells what is known of a match; the trial is registered only when it is accepted."""

    name = "match"
    # Nobody who presses twice accepts what they have not read.
    first = "draw"

    def __init__(self, session: TrainingSession, looked: Future[MatchReport]) -> None:
        super().__init__(session)
        self._looked = looked

    def menu(self) -> Menu:
        """Return what is known so far; what cannot be matched cannot be accepted."""
        if not self._looked.done():
            return self._menu(self.say("match.looking"))
        try:
            report = self._looked.result()
        except (RASTrainerError, OSError) as error:
            return self._menu(self.say("match.impossible", reason=str(error)))
        wrong = (self.say(f"match.{code}", slide=report.slide_mm) for code in report.codes)
        return self._menu(*wrong, self.say("match.residual and error"), report=report)

    def accept(self, item: str) -> None:
        """Register the trial, or continue to draw."""
        if item == "accept":
            self.session.do(CommandName.REGISTER)
        else:
            self.session.pages.show(None)

    def _menu(self, *said: str, report: MatchReport | None = None) -> Menu:
        accept = self.button("accept", is_enabled=report is not None)
        facts = () if report is None else self._facts(report)
        return Menu(self.name, self.say("match.title"), said, facts, (accept, self.button("draw")))

    def _facts(self, report: MatchReport) -> tuple[Fact, ...]:
        low, high = report.interval_mm
        tone = Tone.WARNING if report.codes else Tone.PLAIN
        expected = self.say("result.mm", error=report.expected_mm)
        return (
            Fact(self.say("match.residual"), self.say("result.mm", error=report.residual_mm)),
            Fact(self.say("match.counts"), f"{100.0 * report.inlier_share:.0f} %"),
            Fact(self.say("result.expected tre"), expected, tone),
            Fact(self.say("match.interval"), self.say("match.interval value", low=low, high=high)),
        )
