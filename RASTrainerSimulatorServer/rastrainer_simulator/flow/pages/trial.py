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
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.presentation.screen import Fact, Menu, Tone
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
    """Return what is shown of the match of a trial's trace."""
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
    """Shows what is known of a match; the trial is registered only when it is accepted."""

    name = "match"
    # Someone who presses twice should not accept what they have not read.
    first = "draw"

    def __init__(self, session: TrainingSession, looked: Future[MatchReport]) -> None:
        super().__init__(session)
        self._looked = looked

    def menu(self) -> Menu:
        """Return what is known so far; a trace that cannot be matched cannot be accepted."""
        if not self._looked.done():
            return self._menu(self.say("match.looking"))
        try:
            report = self._looked.result()
        except (RASTrainerError, OSError) as error:
            return self._menu(self.say("match.impossible", reason=str(error)))
        wrong = (self.say(f"match.{code}", slide=report.slide_mm) for code in report.codes)
        return self._menu(*wrong, self.say("match.residual and error"), report=report)

    def accept(self, item: str) -> None:
        """Register the trial, or continue drawing."""
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


class TrialPage(SessionPage):
    """The menu during a trial, which is paused while it is open."""

    name = "trial"

    def menu(self) -> Menu:
        """Return the choices for the trial."""
        training = self.session.training
        task = self.session.task_title(training.task)
        is_complete = training.phase is Phase.COMPLETE
        items = ["resume", "controls", "settings"]
        if training.touches and is_complete:
            items[1:1] = ["register"]
        items.append("finish" if training.task == TRIAL_RUN else "abort")
        key = "trial.complete" if is_complete else "trial.paused"
        traced = 0 if training.trace is None else len(training.trace.points)
        key = f"{key} trace" if traced else key
        return Menu(
            self.name,
            self.say("trial.title", task=task),
            (self.say(key, trainee=training.trainee, kept=len(training.touches), traced=traced),),
            items=tuple(self.button(item) for item in items),
        )

    def accept(self, item: str) -> None:
        """Do what was chosen."""
        session = self.session
        if item == "resume":
            self.back()
        elif item == "register":
            self._register()
        elif item == "finish":
            session.do(CommandName.ABORT, {"reason": AbortReason.TRAINEE.value})
        else:
            pages = {"controls": ControlsPage, "settings": SettingsPage, "abort": AbortPage}
            session.pages.open(pages[item](session))

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

    def pressed(self, control: ControlName) -> bool:
        """The control that pauses also resumes."""
        if control is ControlName.PAUSE:
            self.back()
        return control is ControlName.PAUSE


class PreparingPage(SessionPage):
    """A trial is paused until the trainee's view has drawn its picture; then it goes on."""

    name = "preparing"
    first = "menu"
    _is_resumed = False

    def menu(self) -> Menu:
        """Return how far the picture is."""
        task = self.session.task_title(self.session.training.task)
        said = (self.say("preparing.text", task=task), self.session.preparing())
        items = (self.button("menu", self.say("hint.menu")), self.button("begin"))
        return Menu(self.name, self.say("preparing.title"), said, items=items)

    def accept(self, item: str) -> None:
        """Open the trial's menu, or begin without the picture."""
        if item == "menu":
            self.back()
        else:
            self.session.goes_on_blind = self.session.training.trial_id
            self.session.do(CommandName.RESUME)

    def back(self) -> None:
        """Open the trial's menu."""
        self.session.pages.replace(TrialPage(self.session))

    def advance(self, dt: float) -> None:  # noqa: ARG002
        if self.session.picture_share is None and not self._is_resumed:
            self._is_resumed = True
            self.session.do(CommandName.RESUME)


class AbortPage(SessionPage):
    """Asks for confirmation before a trial is aborted."""

    name = "abort"
    first = "keep"

    def menu(self) -> Menu:
        """Return the question."""
        training = self.session.training
        text = self.say("abort.text", trainee=training.trainee, kept=len(training.touches))
        items = (self.button("keep"), self.button("abort"))
        return Menu(self.name, self.say("abort.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Keep the trial or abort it."""
        if item == "abort":
            self.session.do(CommandName.ABORT, {"reason": AbortReason.TRAINEE.value})
        else:
            self.session.pages.close()


class PracticePage(SessionPage):
    """The trial run's minutes are over: the trainee decides how to continue."""

    name = "practice"
    first = "resume"

    def menu(self) -> Menu:
        """Return the choice."""
        items = (self.button("finish"), self.button("resume"))
        trainee = self.session.training.trainee
        is_led = self.session.study.step_of(trainee) is not None
        text = self.say("practice.study" if is_led else "practice.text", trainee=trainee)
        return Menu(self.name, self.say("practice.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Finish, or keep practicing."""
        if item == "finish":
            self.session.note_done()
            self.session.do(CommandName.ABORT, {"reason": AbortReason.PRACTICE_OVER.value})
        else:
            self.session.do(CommandName.RESUME)

    def back(self) -> None:
        self.accept("resume")


class CompletePage(SessionPage):
    """All points are touched: they are registered, or the last one is undone."""

    name = "complete"

    def menu(self) -> Menu:
        """Return the choice."""
        training = self.session.training
        items = tuple(self.button(item) for item in ("register", "undo", "abort"))
        text = self.say("complete.text", trainee=training.trainee, count=len(training.touches))
        return Menu(self.name, self.say("complete.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Do what was chosen."""
        if item == "abort":
            self.session.pages.open(AbortPage(self.session))
        else:
            self.session.do(CommandName.REGISTER if item == "register" else CommandName.UNDO)
