"""The order of the screens from the start menu to the result (paper, figure 4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from rastrainer.journal.entries import GhostReport, GuidanceReport
from rastrainer.protocol import OPEN_PHASES, PROCEDURE_PHASES, TRIAL_RUN, GhostRule, Guidance, Phase
from rastrainer_simulator.decision.drill import Drill
from rastrainer_simulator.flow.arm_screen import ArmEvents
from rastrainer_simulator.flow.drill_screen import DrillScreen, shown_in_drill
from rastrainer_simulator.flow.pages.case import (
    case_page,
    decision_page,
    leave_drill,
    open_drill,
    truth_page,
)
from rastrainer_simulator.flow.pages.experiment import open_experiment
from rastrainer_simulator.flow.pages.introduction import practiced_page, tutorial_done_page
from rastrainer_simulator.flow.pages.result import ResultPage, waiting_page
from rastrainer_simulator.flow.pages.start import start_page
from rastrainer_simulator.flow.pages.trial_review import ReplayPage
from rastrainer_simulator.flow.procedure_screen import ProcedureScreen
from rastrainer_simulator.flow.session.chosen_trial import begin_ghost, needs_tutorial
from rastrainer_simulator.flow.session.open_pages import Page
from rastrainer_simulator.flow.session.session import HURRY_S, SessionPage, TrainingSession
from rastrainer_simulator.flow.session.tutorial import Tutorial
from rastrainer_simulator.flow.trial_screen import (
    TrialScreen,
    practice_page,
    preparing_page,
    trial_page,
)
from rastrainer_simulator.flow.tutorial_screen import TutorialScreen
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.presentation.feedback_event import touch_feedback
from rastrainer_simulator.presentation.screen import Menu, Screen, ScreenMessage, Tone
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.state import Answer, SimulationState, StepResult, TouchStage, TrialResult
from rastrainer_simulator.texts.texts import key_of

RESULT_PAGES = ("waiting", "result", "replay", "errors", "procedure-errors", "procedure-lines")

PREPARING = preparing_page.name
NOT_RECORDED = "not recorded"
INTERRUPTED = ("interrupted", "interrupted procedure")


class Flow:
    """Follows the trial with the pages, and the trainee's presses with commands.

    The trial's phase decides which page is open, no matter who changed it: a trial that Slicer
    starts, pauses or aborts leads to the same screen as one of the trainee's.
    """

    def __init__(self, session: TrainingSession) -> None:
        self._session = session
        self._control_loop = session.control_loop
        self._arm = ArmEvents()
        self._trial_screen = TrialScreen(session, self._arm)
        self._procedure_screen = ProcedureScreen(session, self._arm, self._trial_screen)
        self._tutorial_screen = TutorialScreen(session, self._arm)
        self._drill_screen = DrillScreen(session, self._arm)
        self._seen_case: tuple[Drill, int, str] | None = None
        self._seen = ("", Phase.IDLE)
        self._seen_result: TrialResult | None = None
        self._touch = TouchStage.FAR
        self._had_slicer = False
        self.waits_for_picture = False
        self._unseen = ""
        session.pages.home = lambda: start_page(session)
        session.pages.show_start()

    @property
    def playback(self) -> Playback | None:
        page = self._session.pages.top
        return page.playback if isinstance(page, ReplayPage) else None

    def shown(self, state: SimulationState) -> SimulationState:
        """Return a state as the trainee sees it; called in any thread."""
        tutorial = self._session.tutorial
        if self._session.drill is not None:
            return shown_in_drill(state)
        return state if tutorial is None else tutorial.practice.shown(state)

    def process_tick(self, result: StepResult) -> None:
        touch = self.shown(result.state).touch
        is_back = key_of(result.state.training.instruction) == NOT_RECORDED
        self._session.feel(result.events, touch, is_back)
        for event in result.events:
            self._arm.note_event(event, self._session.state.tip)
        self._touch = touch

    def advance(self, dt: float, state: SimulationState) -> None:
        session = self._session
        session.advance(dt, state)
        touch = self.shown(state).touch
        felt = touch_feedback(self._touch, touch)
        self._touch = touch
        if felt is not None:
            session.happened(felt)
        training = state.training
        if (training.trial_id, training.phase) != self._seen:
            before, self._seen = self._seen, (training.trial_id, training.phase)
            self._follow(before)
        if training.result is not self._seen_result:
            self._seen_result = training.result
            session.history.changed(training.trainee, training.trial_id)
        if session.ghost.has_just_loaded():
            if session.ghost.rule is GhostRule.OFF:
                session.notices.add(session.say("ghost.none"))
            elif session.has_open_trial:
                self._control_loop.note_display(GhostReport(session.ghost.rule.value))
        is_connected = session.services.is_slicer_connected()
        self._had_slicer = self._had_slicer or is_connected
        is_lost = self._had_slicer and not is_connected
        session.notices.warn("slicer", "warning.slicer" if is_lost else "")
        self._follow_drill()
        self._advance_work(dt)

    def _advance_work(self, dt: float) -> None:
        session = self._session
        if session.pages.top is not None:
            session.pages.advance(dt)
        elif session.tutorial is not None:
            self._advance_tutorial(dt, session.tutorial)
        elif session.drill is not None:
            self._drill_screen.advance()
        elif self._trial_screen.has_practice_just_ended():
            self._trial_screen.open_menu()

    def pressed(self, control: ControlName) -> None:
        if self._session.pages.top is None:
            is_menu = control in (ControlName.MENU, ControlName.PAUSE)
            if is_menu or self._session.picture_share is None:
                self._screen_of_work.pressed(control)
        else:
            self._session.pages.pressed(control)

    def taken_over(self) -> None:
        if self._session.pages.top is None:
            self._screen_of_work.open_menu()

    def pause(self, why: str) -> None:
        """Pause what runs, since no one can see it; `why` is the key of a sentence."""
        if self.playback is not None:
            self.playback.pause(True)
        session, page = self._session, self._session.pages.top
        if session.drill is not None and session.drill.decided is None:
            self._leave_drill()
            return
        # A view that loads its picture may be too busy to say anything.
        if page is not None and page.name == PREPARING and why != "unseen.still":
            self._unseen = why
            session.pages.replace(trial_page(session))
        is_running = session.training.is_running
        if (is_running or session.tutorial is not None) and session.pages.top is None:
            self._unseen = why
            self._screen_of_work.open_menu()

    def screen(self) -> Screen:
        session = self._session
        page, menu = session.pages.top, session.pages.menu()
        warnings = session.notices.shown(session.texts)
        preparing = ScreenMessage(session.preparing())
        if preparing.text and menu is not None and menu.name != PREPARING:
            warnings = (preparing, *warnings)
        shown = None if page is None else page.screen()
        if shown is not None:
            return replace(shown, warnings=(*shown.warnings, *warnings))
        is_at_work = menu is None or session.has_open_trial or session.tutorial is not None
        shown = self._screen_of_work.screen() if is_at_work else Screen()
        if page is not None and menu is not None:
            shown = self._over(shown, page, menu)
        elif preparing.text:
            shown = replace(shown, instruction=preparing)
        return replace(
            shown,
            warnings=(*shown.warnings, *warnings),
            language=session.preferences.language,
            is_spoken=session.preferences.speech,
        )

    def _over(self, shown: Screen, page: Page, menu: Menu) -> Screen:
        session, say = self._session, self._session.say
        said = session.training.instruction
        why: tuple[ScreenMessage, ...] = ()
        tones = {**dict.fromkeys(INTERRUPTED, Tone.WARNING), NOT_RECORDED: Tone.ERROR}
        if self._unseen:
            why = (ScreenMessage(say(self._unseen), Tone.WARNING),)
        elif key_of(said) in tones:
            why = (ScreenMessage(session.texts.again(said), tones[key_of(said)]),)
        in_head = shown if self._procedure_screen.is_open else Screen()
        hint = session.operator.hint
        return Screen(
            menu=replace(menu, clock=session.drill_clock),
            warnings=why,
            status=shown.status,
            hints=(
                hint("hint.choose", ControlName.UP, ControlName.DOWN),
                hint("hint.accept", ControlName.ACCEPT),
                hint("hint.back", ControlName.BACK),
            ),
            errors=in_head.errors,
            is_head_clear=in_head.is_head_clear,
            is_private=page.is_private,
        )

    def start_tutorial(self, trainee: str, mode: str) -> Answer:
        """Open the tutorial because Slicer wants the trial run to come next, if it is to be first.

        The answer's `isNeeded` says whether the trial run has to wait for it.
        """
        session = self._session
        if refused := self._refused(trainee, session.tutorial):
            return Answer(0, False, refused)
        if session.tutorial is None:
            session.trainee, session.mode = trainee, mode
            if not needs_tutorial(session):
                return Answer(0, True, data={"isNeeded": False})
            session.begin_tutorial()
        return Answer(0, True, data={"isNeeded": True})

    def start_drill(self, trainee: str, mode: str) -> Answer:
        """Open the trainee's drill of decisions, because Slicer wants it.

        The answer has a `trialId` unless the trainee still has to read the explanation.
        """
        session = self._session
        if refused := self._refused(trainee, session.drill):
            return Answer(0, False, refused)
        if session.drill is None:
            session.trainee, session.mode = trainee, mode
            session.pages.show_start()
            open_drill(session)
        drill = session.drill
        return Answer(0, True, data={} if drill is None else {"trialId": drill.trial_id})

    def _refused(self, trainee: str, own: Tutorial | Drill | None) -> str:
        """Return why Slicer cannot open or show the trainee's `own` work; "" if it can."""
        session, say = self._session, self._session.say
        if session.has_open_trial:
            open_ = session.training
            task = session.task_title(open_.task)
            return say("trial is open", trainee=open_.trainee, task=task)
        for key, work in (("tutorial is open", session.tutorial), ("drill is open", session.drill)):
            if work is not None and (work is not own or work.trainee != trainee):
                return say(key, trainee=work.trainee)
        return say("being set up") if own is None and session.reload.is_under_way else ""

    @property
    def _screen_of_work(self) -> TrialScreen | ProcedureScreen | TutorialScreen | DrillScreen:
        if self._session.tutorial is not None:
            return self._tutorial_screen
        if self._session.drill is not None:
            return self._drill_screen
        is_at_procedure = self._procedure_screen.is_open
        return self._procedure_screen if is_at_procedure else self._trial_screen

    def _follow_drill(self) -> None:
        """Warn of the end of a case, ask for its decision then, and tell the truth after it."""
        session, clock = self._session, self._session.drill_clock
        is_hurried = clock is not None and clock.tone is Tone.WARNING
        session.notices.warn("clock", "case.hurry" if is_hurried else "", seconds=HURRY_S)
        drill = session.drill
        if drill is None:
            return
        if drill.header.scenario.name != session.scenario.name:
            self._leave_drill()
            return
        stage = "late" if clock is not None and drill.left_s <= 0.0 else ""
        if drill.is_ready and drill.decided is not None:
            stage = "decided"
        before, self._seen_case = self._seen_case, (drill, drill.number, stage)
        if self._seen_case == before:
            return
        if stage == "decided":
            session.pages.show(truth_page(session))
        elif stage:
            session.pages.show(case_page(session))
            session.pages.open(decision_page(session), ignore_input_briefly=True)

    def _leave_drill(self) -> None:
        """Leave a drill that cannot go on now; it is kept."""
        session = self._session
        leave_drill(session)
        session.notices.add(session.say("case-leave.kept"), Tone.WARNING)

    def _advance_tutorial(self, dt: float, tutorial: Tutorial) -> None:
        session = self._session
        self._unseen = ""
        if session.picture_share is not None and tutorial.setup is self._control_loop.setup:
            return
        if tutorial.setup is not self._control_loop.setup:
            session.end_tutorial()
            session.notices.add(session.say("tutorial.head is gone"), Tone.WARNING)
            session.pages.show_start()
            return
        self._tutorial_screen.advance(dt)
        if tutorial.step is None and tutorial.praised is None:
            outcome = session.end_tutorial()
            open_experiment(session)
            if outcome is not None:
                page = practiced_page if tutorial.practiced else tutorial_done_page
                session.pages.open(page(session, outcome), ignore_input_briefly=True)

    def _follow(self, before: tuple[str, Phase]) -> None:
        session = self._session
        training = session.training
        session.history.changed(training.trainee, training.trial_id)
        # Another client started or ended a trial: leave the tutorial.
        session.end_tutorial()
        self._note_trial(before[0])
        if session.drill is not None:
            if not session.has_open_trial:
                return
            self._leave_drill()
        is_requested = self._trial_screen.has_requested_menu
        self._trial_screen.has_requested_menu = False
        was_working = session.pages.top is None
        top_name = "" if session.pages.top is None else session.pages.top.name
        if training.phase in (Phase.RUNNING, Phase.COMPLETE, *PROCEDURE_PHASES):
            session.pages.show(None)
        elif training.phase is Phase.PAUSED:
            page: Callable[[TrainingSession], SessionPage]
            page = preparing_page if self.waits_for_picture else trial_page
            page = practice_page if self._trial_screen.is_practice_over else page
            session.pages.show(page(session), ignore_input_briefly=not is_requested)
        elif training.phase is Phase.REGISTERED:
            session.note_done()
            session.services.assigned.note_registered(
                training.trainee, training.task, training.mode
            )
            session.pages.show(waiting_page(session), ignore_input_briefly=True)
        elif training.phase is Phase.SCORED:
            session.pages.show(ResultPage(session), ignore_input_briefly=True)
        elif before[1] in OPEN_PHASES or top_name in RESULT_PAGES:
            # Another simulation may follow a trial while other pages are open: they stay.
            open_experiment(session, ignore_input_briefly=was_working)

    def _note_trial(self, previous_id: str) -> None:
        session = self._session
        training = session.training
        if training.phase is not Phase.PAUSED:
            self._unseen = ""
        if training.trial_id and training.trial_id != previous_id:
            truth = self._control_loop.simulation.truth
            self._trial_screen.begin(truth)
            guidance = self._trial_screen.guidance
            self._control_loop.note_display(GuidanceReport(guidance.value))
            learned = session.history.learned.get(training.trainee)
            if training.task == TRIAL_RUN and learned is not None:
                self._control_loop.note_display(learned)
            session.view.begin(session.control_loop.setup, session.state)
            session.view.control.reset()
            is_led = training.trace is not None and guidance is not Guidance.NONE
            traced = training.trial_id, session.control_loop.setup, truth
            session.places.begin(traced if is_led else None)
            begin_ghost(session, truth.head_to_world)
            session.trainee = training.trainee
            session.mode = training.mode
        if training.phase is Phase.COMPLETE and training.task == TRIAL_RUN:
            session.note_done()
