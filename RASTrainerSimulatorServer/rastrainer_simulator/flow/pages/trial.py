"""The pages over an open trial: the menu, pausing, aborting, registering.

A trace is registered once its match has been looked at: a small residual does not mean a small
error, so that both are shown, and what looks wrong with the match.
"""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from rastrainer.commands import CommandName
from rastrainer.errors import RASTrainerError
from rastrainer.protocol import TRIAL_RUN, AbortReason, Phase
from rastrainer.registration.fits import RIGID
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.flow.pages.controls import controls_page
from rastrainer_simulator.flow.pages.session_page import SessionPage, page_kind
from rastrainer_simulator.flow.pages.start import settings_page
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


def match_report(training: TrainingState, scenario: Scenario) -> MatchReport:
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


@page_kind("match")
def match_page(page: SessionPage, looked: Future[MatchReport]) -> PageContent:
    """Show the figures of a match; the trial is registered only when it is accepted."""
    session, say = page.session, page.say
    report: MatchReport | None = None
    said: tuple[str, ...] = (say("match.looking"),)
    facts: tuple[Fact, ...] = ()
    if looked.done():
        try:
            report = looked.result()
        except (RASTrainerError, OSError) as error:
            said = (say("match.impossible", reason=str(error)),)
    if report is not None:
        wrong = (say(f"match.{code}", slide=report.slide_mm) for code in report.codes)
        said = (*wrong, say("match.residual and error"))
        low, high = report.interval_mm
        tone = Tone.WARNING if report.codes else Tone.PLAIN
        expected = say("result.mm", error=report.expected_mm)
        facts = (
            Fact(say("match.residual"), say("result.mm", error=report.residual_mm)),
            Fact(say("match.counts"), f"{100.0 * report.inlier_share:.0f} %"),
            Fact(say("result.expected tre"), expected, tone),
            Fact(say("match.interval"), say("match.interval value", low=low, high=high)),
        )
    register = partial(session.do, CommandName.REGISTER)
    rows = (
        page.button("accept", register, is_enabled=report is not None),
        page.button("draw", lambda: session.pages.show(None)),
    )
    # A double press must not accept a match that was not read.
    return PageContent(say("match.title"), said, facts, rows, first="draw")


def _resume(session: TrainingSession) -> None:
    if session.training.phase is Phase.PAUSED:
        session.do(CommandName.RESUME)
    else:
        session.pages.close()


@page_kind("trial", leave=_resume, pause_goes_back=True)
def trial_page(page: SessionPage) -> PageContent:
    """Show the menu during a trial, which is paused while it is open."""
    session, training = page.session, page.session.training
    is_complete = training.phase is Phase.COMPLETE
    traced = 0 if training.trace is None else len(training.trace.points)
    key = ("trial.complete" if is_complete else "trial.paused") + (" trace" if traced else "")
    text = page.say(key, trainee=training.trainee, kept=len(training.touches), traced=traced)

    def register() -> None:
        """Register the trial; if there is a trace, its match is shown first."""
        if session.training.trace is None:
            session.do(CommandName.REGISTER)
            return
        # Set aside while it holds the interpreter, it would make the control loop wait.
        worker = ThreadPoolExecutor(1, "match", raise_thread_priority)
        looked = worker.submit(match_report, session.training, session.scenario)
        worker.shutdown(wait=False)
        session.pages.open(match_page(session, looked))

    end = page.button("abort", page.open_page(abort_page))
    if training.task == TRIAL_RUN:
        end = page.button("finish", _abort(session, AbortReason.TRAINEE))
    rows = (
        page.button("resume"),
        *((page.button("register", register),) if training.touches and is_complete else ()),
        page.button("controls", page.open_page(controls_page)),
        page.button("settings", page.open_page(settings_page)),
        end,
    )
    title = page.say("trial.title", task=session.task_title(training.task))
    return PageContent(title, (text,), rows=rows)


def _abort(session: TrainingSession, reason: AbortReason) -> partial[None]:
    return partial(session.do, CommandName.ABORT, {"reason": reason.value})


class PreparingPage(SessionPage):
    """A trial is paused until the trainee's view has drawn its picture; then it goes on."""

    name = "preparing"
    _is_resumed = False

    def content(self) -> PageContent:
        session = self.session

        def begin_without_picture() -> None:
            session.goes_on_blind = session.training.trial_id
            session.do(CommandName.RESUME)

        task = session.task_title(session.training.task)
        said = (self.say("preparing.text", task=task), session.preparing())
        rows = (
            self.button("menu", label=self.say("hint.menu")),
            self.button("begin", begin_without_picture),
        )
        return PageContent(self.say("preparing.title"), said, rows=rows, first="menu")

    def back(self) -> None:
        self.session.pages.replace(trial_page(self.session))

    def advance(self, dt: float) -> None:  # noqa: ARG002
        if self.session.picture_share is None and not self._is_resumed:
            self._is_resumed = True
            self.session.do(CommandName.RESUME)


@page_kind("abort")
def abort_page(page: SessionPage) -> PageContent:
    """Ask for confirmation before a trial is aborted."""
    training = page.session.training
    text = page.say("abort.text", trainee=training.trainee, kept=len(training.touches))
    abort = _abort(page.session, AbortReason.TRAINEE)
    rows = (page.button("keep"), page.button("abort", abort))
    return PageContent(page.say("abort.title"), (text,), rows=rows, first="keep")


@page_kind("practice", leave=lambda session: session.do(CommandName.RESUME))
def practice_page(page: SessionPage) -> PageContent:
    """Say that the trial run's minutes are over: the trainee decides how to continue."""
    session = page.session
    is_led = session.trial_step is not None
    key = "practice.study" if is_led else "practice.text"

    def finish() -> None:
        session.note_done()
        _abort(session, AbortReason.PRACTICE_OVER)()

    rows = (page.button("finish", finish), page.button("resume"))
    text = page.say(key, trainee=session.training.trainee)
    return PageContent(page.say("practice.title"), (text,), rows=rows, first="resume")


@page_kind("complete")
def complete_page(page: SessionPage) -> PageContent:
    """Say that all points are touched: they are registered, or the last one is undone."""
    session, training = page.session, page.session.training
    text = page.say("complete.text", trainee=training.trainee, count=len(training.touches))
    rows = (
        page.button("register", partial(session.do, CommandName.REGISTER)),
        page.button("undo", partial(session.do, CommandName.UNDO)),
        page.button("abort", page.open_page(abort_page)),
    )
    return PageContent(page.say("complete.title"), (text,), rows=rows)
