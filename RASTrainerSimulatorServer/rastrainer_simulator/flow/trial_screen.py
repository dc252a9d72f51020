"""An open trial: what the trainee reads and does while driving the arm, and the pages over it.

A trace is registered once its match has been looked at: a small residual does not mean a small
error, so that both are shown, and what looks wrong with the match.
"""

from __future__ import annotations

import math
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial

from rastrainer.commands import CommandName
from rastrainer.errors import RASTrainerError
from rastrainer.number_text import clock
from rastrainer.protocol import (
    FIDUCIAL_COUNT,
    MAX_TRACE_POINTS,
    MIN_TRACE_POINTS,
    TRIAL_RUN,
    AbortReason,
    Guidance,
    Phase,
    StepKind,
)
from rastrainer.registration.fits import RIGID
from rastrainer.registration.surface_checks import SurfaceMatch
from rastrainer.scenario.scenario import Scenario
from rastrainer.study_messages import StudyStep
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.touch_registration import GivenPoints, TouchRegistration, register_trial
from rastrainer_simulator.flow.arm_screen import (
    BACK_WITHIN,
    FARTHEST,
    LOOKED_AT_MM,
    PRACTICED_MM,
    ArmScreen,
    off_path,
)
from rastrainer_simulator.flow.pages.controls import controls_page
from rastrainer_simulator.flow.pages.start import settings_page, start_page
from rastrainer_simulator.flow.pages.trial_review import POOR_MM
from rastrainer_simulator.flow.session.chosen_trial import guidance_of
from rastrainer_simulator.flow.session.open_pages import PageContent, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.presentation.screen import Fact, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.state import TouchStage, TrainingState
from rastrainer_simulator.training.head_pose import Truth
from rastrainer_simulator.training.replies import given
from rastrainer_simulator.vectors import ZERO, Vector, distance, in_meters

TRIAL_RUN_S = 300.0
"""How long the trial run is free (the paper's flow, figure 4)."""

ELSEWHERE_M = 0.003
"""This far from a refused touch, the tip on the skin is about to touch again."""


@dataclass(eq=False)
class TrialScreen(ArmScreen):
    """The instructions, warnings and hints of an open trial, and its controls."""

    guidance: Guidance = Guidance.NONE
    has_requested_menu: bool = False
    _points: dict[str, Vector] = field(default_factory=dict)
    _count: int = FIDUCIAL_COUNT
    _center: Vector = ZERO
    _is_beside: bool = False
    _is_practice_end_shown: bool = False
    _practice_step: StudyStep | None = None
    _practice_end_s: float | None = None

    def screen(self) -> Screen:
        session = self._session
        training = session.training
        is_complete = training.phase is Phase.COMPLETE and not training.is_tracing
        touch = "hint.register" if is_complete else "hint.touch"
        names = {
            ControlName.TOUCH: "hint.trace" if training.is_tracing else touch,
            ControlName.UNDO: "hint.undo",
            ControlName.FINE: "hint.fine",
            ControlName.BEST_VIEW: "hint.best_view",
            ControlName.CAMERA: "hint.front",
            ControlName.MENU: "hint.menu",
        }
        movement: tuple[Hint, ...] = ()
        if session.operator.is_one_of(SourceKind.XR):
            # In a headset the head turns the view, and the sticks are drawn in the hands.
            del names[ControlName.BEST_VIEW]
        elif not is_complete:
            movement = self._movement_hints()
        covered = session.places.guidance(session.state).covered_mm
        legend = session.say("coverage", distance=f"{covered:.0f}") if covered else ""
        return self._shown(
            self._instruction(),
            self._status(),
            self._hints(movement, names),
            has_arrow=self.guidance is not Guidance.NONE,
            coverage=legend,
        )

    @property
    def is_practice_over(self) -> bool:
        state = self._session.state
        return state.training.task == TRIAL_RUN and state.elapsed >= self._practice_s

    @property
    def _practice_s(self) -> float:
        """The trial's time at which the trial run's minutes are over: a study sets its own.

        It stays when Slicer continues the study, a moment before or after it.
        """
        state, step = self._session.state, self._session.trial_step
        is_run = step is not None and step.kind == StepKind.TRIAL_RUN
        if step is not None and is_run and step is not self._practice_step:
            self._practice_step = step
            self._practice_end_s = state.elapsed + step.left_s()
        return TRIAL_RUN_S if self._practice_end_s is None else self._practice_end_s

    def has_practice_just_ended(self) -> bool:
        if self._is_practice_end_shown or self._session.training.phase is not Phase.RUNNING:
            return False
        self._is_practice_end_shown = self.is_practice_over
        return self._is_practice_end_shown

    def begin(self, truth: Truth) -> None:
        """Forget the trial before; the trainee is not led to points that are not marked."""
        points = truth.fiducials_ras if self._session.training.is_marked else {}
        self._points = {name: in_meters(truth.in_world(place)) for name, place in points.items()}
        self._count = len(truth.fiducials_ras)
        self._center = in_meters(truth.in_world(truth.target_ras))
        self._is_beside = self._is_practice_end_shown = False
        self._arm.obstacle, self._arm.is_within_reach = "", True
        self._practice_step, self._practice_end_s = None, None
        self.guidance = guidance_of(self._session)

    def pressed(self, control: ControlName) -> None:
        session = self._session
        training = session.training
        match control:
            case ControlName.CAMERA:
                self._change_camera()
            case ControlName.BEST_VIEW if training.is_tracing:
                orbit = session.places.orbit(session.scenario.cameras[session.state.camera])
                if orbit is not None:
                    session.view.control.go(orbit)
            case ControlName.BEST_VIEW:
                session.view.is_best_wanted = True
            case ControlName.UNDO:
                session.do(CommandName.UNDO)
            case ControlName.TOUCH if training.is_tracing:
                trace = training.trace
                session.do(CommandName.TRACE, {"on": trace is None or not trace.is_on})
            case ControlName.TOUCH if training.phase is Phase.COMPLETE:
                session.pages.open(complete_page(session))
            case ControlName.TOUCH:
                session.do(CommandName.CAPTURE)
            case ControlName.MENU | ControlName.PAUSE:
                self.has_requested_menu = True
                self.open_menu()

    def open_menu(self) -> None:
        """Open the menu; a trial that runs is paused, and the menu opens when it is."""
        session = self._session
        phase = session.training.phase
        if session.training.is_running:
            session.do(CommandName.PAUSE)
        else:
            page = trial_page if phase is Phase.COMPLETE else start_page
            session.pages.show(page(session))

    def _instruction(self) -> ScreenMessage:
        session = self._session
        training = session.training
        if training.is_tracing and not self._is_refused:
            return self._instructed(Tone.GOOD if training.phase is Phase.COMPLETE else Tone.PLAIN)
        if training.phase is Phase.COMPLETE:
            key, count = session.operator.label(ControlName.TOUCH), len(training.touches)
            who = training.trainee
            return self._message("work.complete", Tone.GOOD, trainee=who, count=count, touch=key)
        is_on_skin = session.state.touch is TouchStage.ON_SKIN
        has_gone_on = is_on_skin and distance(session.state.tip, self._arm.refused_at) > ELSEWHERE_M
        if self._is_refused and not has_gone_on:
            return self._instructed(Tone.WARNING)
        if is_on_skin:
            return self._on_skin()
        if self._is_off_the_path():
            who, point = training.trainee, training.next_point
            return self._message("work.off the way", Tone.WARNING, trainee=who, point=point)
        last = training.touches[-1] if training.touches else None
        if training.task == TRIAL_RUN and last is not None and last.label in self._points:
            # Where touches are scored, nothing says how exact they are before the registration.
            error_mm = MM_PER_M * distance(last.position, self._points[last.label])
            if error_mm >= POOR_MM:
                return self._touched("tutorial.slipped", Tone.WARNING, last.label, error_mm)
        return self._instructed(Tone.GOOD if training.touches else Tone.PLAIN)

    def _status(self) -> list[str]:
        session = self._session
        training = session.training
        say, trace = session.say, training.trace
        done = say("status.points", kept=len(training.touches), count=self._count)
        if training.is_tracing and trace is not None:
            limits = {"least": MIN_TRACE_POINTS, "most": MAX_TRACE_POINTS}
            done = say("status.traced", traced=len(trace.points), **limits)
        passed = clock(session.state.completion_time)
        if training.task == TRIAL_RUN:
            # Rounding first: an error in a float's last digit must not add a second.
            left = math.ceil(max(0.0, round(self._practice_s - session.state.elapsed, 6)))
            passed = say("status.left", time=clock(left))
        facts = [session.task_title(training.task), done, passed]
        target = self._points.get(training.next_point or "")
        name = say("status.point", point=training.next_point)
        if training.is_tracing:
            target, name = session.places.in_world(), say("status.next place")
        if target is not None and self.guidance is Guidance.WORDS:
            is_practice = training.task == TRIAL_RUN and not training.is_tracing
            nearest_mm = PRACTICED_MM if is_practice else LOOKED_AT_MM
            facts.append(self._toward(name, target, nearest_mm))
        return facts

    def _is_off_the_path(self) -> bool:
        training = self._session.training
        target = self._points.get(training.next_point or "")
        if self.guidance is Guidance.NONE or not training.touches or target is None:
            self._is_beside = False
            return False
        off = off_path(self._session.state.tip, self._center, training.touches[-1].position, target)
        self._is_beside = off > (BACK_WITHIN if self._is_beside else FARTHEST)
        return self._is_beside


def registration_so_far(training: TrainingState, scenario: Scenario) -> TouchRegistration:
    answer = {"task": training.task, "method": training.method.value, **given(training)}
    return register_trial(GivenPoints.of_answer(answer), scenario)


@page_kind("match")
def match_page(page: SessionPage, looked: Future[TouchRegistration]) -> PageContent:
    """Show the figures of a match; the trial is registered only when it is accepted."""
    session, say = page.session, page.say
    match: SurfaceMatch | None = None
    said: tuple[str, ...] = (say("match.looking"),)
    facts: tuple[Fact, ...] = ()
    if looked.done():
        try:
            match, at_target = looked.result().match, looked.result().target_errors[RIGID]
        except (RASTrainerError, OSError) as error:
            said = (say("match.impossible", reason=str(error)),)
    if match is not None:
        slide = match.slide.distance_mm
        wrong = (say(f"match.{warning.code}", slide=slide) for warning in match.warnings)
        said = (*wrong, say("match.residual and error"))
        low, high = at_target.interval_mm
        tone = Tone.WARNING if match.warnings else Tone.PLAIN
        expected = say("result.mm", error=at_target.expected_mm)
        facts = (
            Fact(say("match.residual"), say("result.mm", error=match.rms_mm)),
            Fact(say("match.counts"), f"{100.0 * match.inlier_share:.0f} %"),
            Fact(say("result.expected tre"), expected, tone),
            Fact(say("match.interval"), say("match.interval value", low=low, high=high)),
        )
    register = partial(session.do, CommandName.REGISTER)
    rows = (
        page.button("accept", register, is_enabled=match is not None),
        page.button("draw", lambda: session.pages.show(None)),
    )
    # A double press must not accept a match that was not read.
    return PageContent(said, facts, rows, first="draw")


def _resume(page: SessionPage) -> None:
    session = page.session
    if session.training.phase is Phase.PAUSED:
        session.do(CommandName.RESUME)
    else:
        session.pages.close()


@page_kind("trial", back=_resume, pause_goes_back=True)
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
        looked = worker.submit(registration_so_far, session.training, session.scenario)
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
    return PageContent((text,), rows=rows, title=title)


def _abort(session: TrainingSession, reason: AbortReason) -> partial[None]:
    return partial(session.do, CommandName.ABORT, {"reason": reason.value})


def _resume_with_picture(page: SessionPage, _dt: float, is_resumed: bool = False) -> None:
    if page.session.picture_share is None and not is_resumed:
        page.set_value("is_resumed", True)
        page.session.do(CommandName.RESUME)


@page_kind(
    "preparing",
    back=lambda page, **_values: page.session.pages.replace(trial_page(page.session)),
    advance=_resume_with_picture,
)
def preparing_page(page: SessionPage, **_values: bool) -> PageContent:
    """Have a trial wait until the trainee's view has drawn its picture."""
    session = page.session

    def begin_without_picture() -> None:
        session.goes_on_blind = session.training.trial_id
        session.do(CommandName.RESUME)

    task = session.task_title(session.training.task)
    said = (page.say("preparing.text", task=task), session.preparing())
    rows = (
        page.button("menu", label=page.say("hint.menu")),
        page.button("begin", begin_without_picture),
    )
    return PageContent(said, rows=rows, first="menu")


@page_kind("abort")
def abort_page(page: SessionPage) -> PageContent:
    training = page.session.training
    text = page.say("abort.text", trainee=training.trainee, kept=len(training.touches))
    abort = _abort(page.session, AbortReason.TRAINEE)
    rows = (page.button("keep"), page.button("abort", abort))
    return PageContent((text,), rows=rows, first="keep")


@page_kind("practice", back=lambda page: page.session.do(CommandName.RESUME))
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
    return PageContent((text,), rows=rows, first="resume")


@page_kind("complete")
def complete_page(page: SessionPage) -> PageContent:
    session, training = page.session, page.session.training
    text = page.say("complete.text", trainee=training.trainee, count=len(training.touches))
    rows = (
        page.button("register", partial(session.do, CommandName.REGISTER)),
        page.button("undo", partial(session.do, CommandName.UNDO)),
        page.button("abort", page.open_page(abort_page)),
    )
    return PageContent((text,), rows=rows)
