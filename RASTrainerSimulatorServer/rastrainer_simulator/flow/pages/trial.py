"""The pages over an open trial: the menu, pausing, aborting, registering.

A trace is registered once its match has been looked at: a small residual does not mean a small
error, so that both are shown, and what looks wrong with the match.
"""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from rastrainer.commands import CommandName
from rastrainer.errors import RASTrainerError
from rastrainer.protocol import TRIAL_RUN, AbortReason, Phase
from rastrainer.registration.fits import RIGID
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.flow.pages.controls import ControlsPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.start import SettingsPage
from rastrainer_simulator.flow.session.open_pages import PageContent
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.presentation.screen import Fact, Tone
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.replies import given


@dataclass(frozen=True)
class MatchReport:
    """A match as numbers, lengths in mm, and the codes of what looks wrong with it.

    Attributes:
        residual_mm: root mean square of the distances of the points that count from the skin.
        inlier_share: share of the points that count.
        expected_mm: expected TRE at the target.
        interval_mm: the 95 % interval of the TRE there.
        slide_mm: how far the head may be off where the trace determines it least.
        codes: as of `find_match_warnings`.
    """

    residual_mm: float
    inlier_share: float
    expected_mm: float
    interval_mm: tuple[float, float]
    slide_mm: float
    codes: tuple[str, ...] = ()


def look_at_match(training: TrainingState, scenario: Scenario) -> Future[MatchReport]:
    """Have the trace of an open trial matched as it will be when it is registered.

    The result raises an InputError where it cannot be.
    """
    # Set aside while it holds the interpreter, it would make the control loop wait.
    worker = ThreadPoolExecutor(1, "match", raise_thread_priority)
    looked = worker.submit(match_report, training, scenario)
    worker.shutdown(wait=False)
    return looked


def match_report(training: TrainingState, scenario: Scenario) -> MatchReport:
    """Return the figures of the match of a trial's trace."""
    answer = {"task": training.task, "method": training.method.value, **given(training)}
    registered = register_trial(GivenPoints.of_answer(answer), scenario)
    match, error = registered.match, registered.target_errors[RIGID]
    assert match is not None, "the method has a trace"
    return MatchReport(
        match.rms_mm,
        match.inlier_share,
        error.expected_mm,
        error.interval_mm,
        match.slide.distance_mm,
        tuple(warning.code for warning in match.warnings),
    )


class MatchPage(SessionPage):
    """Shows the figures of a match; the trial is registered only when it is accepted."""

    name = "match"
    # A double press must not accept a match that was not read.
    first = "draw"

    def __init__(self, session: TrainingSession, looked: Future[MatchReport]) -> None:
        super().__init__(session)
        self._looked = looked

    def content(self) -> PageContent:
        report: MatchReport | None = None
        said: tuple[str, ...] = (self.say("match.looking"),)
        if self._looked.done():
            try:
                report = self._looked.result()
            except (RASTrainerError, OSError) as error:
                said = (self.say("match.impossible", reason=str(error)),)
            else:
                wrong = (self.say(f"match.{code}", slide=report.slide_mm) for code in report.codes)
                said = (*wrong, self.say("match.residual and error"))
        register = self.command(CommandName.REGISTER)
        rows = (
            self.button("accept", register, is_enabled=report is not None),
            self.button("draw", lambda: self.session.pages.show(None)),
        )
        facts = () if report is None else self._facts(report)
        return PageContent(self.say("match.title"), said, facts, rows)

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


class TrialPage(SessionPage):
    """The menu during a trial, which is paused while it is open."""

    name = "trial"
    pause_goes_back = True

    def content(self) -> PageContent:
        training = self.session.training
        is_complete = training.phase is Phase.COMPLETE
        traced = 0 if training.trace is None else len(training.trace.points)
        key = ("trial.complete" if is_complete else "trial.paused") + (" trace" if traced else "")
        text = self.say(key, trainee=training.trainee, kept=len(training.touches), traced=traced)
        is_run = training.task == TRIAL_RUN
        finish = self.command(CommandName.ABORT, reason=AbortReason.TRAINEE.value)
        may_register = training.touches and is_complete
        rows = (
            self.button("resume"),
            *((self.button("register", self._register),) if may_register else ()),
            self.button("controls", self.open_page(ControlsPage)),
            self.button("settings", self.open_page(SettingsPage)),
            self.button("finish", finish)
            if is_run
            else self.button("abort", self.open_page(AbortPage)),
        )
        title = self.say("trial.title", task=self.session.task_title(training.task))
        return PageContent(title, (text,), rows=rows)

    def back(self) -> None:
        """Resume the trial."""
        if self.session.training.phase is Phase.PAUSED:
            self.session.do(CommandName.RESUME)
        else:
            self.session.pages.close()

    def _register(self) -> None:
        """Register the trial; if there is a trace, its match is shown first."""
        session = self.session
        if session.training.trace is None:
            session.do(CommandName.REGISTER)
        else:
            looked = look_at_match(session.training, session.scenario)
            session.pages.open(MatchPage(session, looked))


class PreparingPage(SessionPage):
    """A trial is paused until the trainee's view has drawn its picture; then it goes on."""

    name = "preparing"
    first = "menu"
    _is_resumed = False

    def content(self) -> PageContent:
        task = self.session.task_title(self.session.training.task)
        said = (self.say("preparing.text", task=task), self.session.preparing())
        rows = (
            self.button("menu", label=self.say("hint.menu")),
            self.button("begin", self._begin_without_picture),
        )
        return PageContent(self.say("preparing.title"), said, rows=rows)

    def back(self) -> None:
        self.session.pages.replace(TrialPage(self.session))

    def advance(self, dt: float) -> None:  # noqa: ARG002
        if self.session.picture_share is None and not self._is_resumed:
            self._is_resumed = True
            self.session.do(CommandName.RESUME)

    def _begin_without_picture(self) -> None:
        self.session.goes_on_blind = self.session.training.trial_id
        self.session.do(CommandName.RESUME)


class AbortPage(SessionPage):
    """Asks for confirmation before a trial is aborted."""

    name = "abort"
    first = "keep"

    def content(self) -> PageContent:
        training = self.session.training
        text = self.say("abort.text", trainee=training.trainee, kept=len(training.touches))
        abort = self.command(CommandName.ABORT, reason=AbortReason.TRAINEE.value)
        rows = (self.button("keep"), self.button("abort", abort))
        return PageContent(self.say("abort.title"), (text,), rows=rows)


class PracticePage(SessionPage):
    """The trial run's minutes are over: the trainee decides how to continue."""

    name = "practice"
    first = "resume"

    def content(self) -> PageContent:
        trainee = self.session.training.trainee
        is_led = self.session.trial_step is not None
        text = self.say("practice.study" if is_led else "practice.text", trainee=trainee)
        rows = (self.button("finish", self._finish), self.button("resume"))
        return PageContent(self.say("practice.title"), (text,), rows=rows)

    def back(self) -> None:
        """Keep practicing."""
        self.session.do(CommandName.RESUME)

    def _finish(self) -> None:
        self.session.note_done()
        self.session.do(CommandName.ABORT, {"reason": AbortReason.PRACTICE_OVER.value})


class CompletePage(SessionPage):
    """All points are touched: they are registered, or the last one is undone."""

    name = "complete"

    def content(self) -> PageContent:
        training = self.session.training
        text = self.say("complete.text", trainee=training.trainee, count=len(training.touches))
        rows = (
            self.button("register", self.command(CommandName.REGISTER)),
            self.button("undo", self.command(CommandName.UNDO)),
            self.button("abort", self.open_page(AbortPage)),
        )
        return PageContent(self.say("complete.title"), (text,), rows=rows)
