"""Reviewing scored trials: the errors of touches on the head, replays, and the list of trials."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial

from rastrainer.errors import InputError
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.pages.session_page import SessionPage, clickable_hint, page_kind
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.plan_marks import plan_marks, scored_lines
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.session.trainee_history import OwnTrial
from rastrainer_simulator.input.inputs import ControlContext, ControlName, InputDevice, SourceKind
from rastrainer_simulator.presentation.screen import ErrorArrow, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.replay.recorded_trial import TrialLoading
from rastrainer_simulator.replay.replay_presenter import Player, replay_control
from rastrainer_simulator.trial_state import PlannedLine
from rastrainer_simulator.vectors import Vector, add, length, scale, subtract

GOOD_MM = 2.0
POOR_MM = 4.0
"""Errors up to the first are good, from the second on they are poor: what frameless stereotaxy
reaches in the clinic lies between them."""
STEP_DEG = 10.0
"""Angle by which each press turns the view; held inputs repeat."""
_TURNS = {
    ControlName.LEFT: (-STEP_DEG, 0.0),
    ControlName.RIGHT: (STEP_DEG, 0.0),
    ControlName.UP: (0.0, STEP_DEG),
    ControlName.DOWN: (0.0, -STEP_DEG),
}
"""Around the head to the right, and higher, degrees."""
LONGER = 5.0
"""An error of a millimeter would be hardly visible."""


class ErrorsPage(SessionPage):
    """Shows errors in the head, without a menu: of touches, or of a procedure's lines."""

    def __init__(self, session: TrainingSession, has_lines: bool = False) -> None:
        super().__init__(session)
        self._has_lines = has_lines
        self.name = "procedure-lines" if has_lines else "errors"

    def content(self) -> PageContent:
        title = self.say(f"{self.name}.title", longer=LONGER, good=GOOD_MM, poor=POOR_MM)
        return PageContent(rows=(self.button("back"),), title=title)

    def screen(self) -> Screen:
        """Return arrows or lines at the true pose of the head, which the score has revealed."""
        session, training = self.session, self.session.training
        errors: Iterable[ErrorArrow] = ()
        if self._has_lines and training.procedure is not None and training.result is not None:
            plan = session.scenario.procedure(training.procedure.name).trajectories
            ends = (map(session.truly_in_world, (each.entry_ras, each.target_ras)) for each in plan)
            true = (PlannedLine("", *line) for line in ends)
            errors = scored_lines(true, training.procedure)
        elif training.result is not None:
            fiducials = session.control_loop.simulation.truth.fiducials_ras
            errors = (
                error_arrow(session.truly_in_world(fiducials[t.label]), t.position)
                for t in training.touches
            )
        back = Hint(session.operator.label(ControlName.BACK), self.say("hint.result"), "back")
        hints: tuple[Hint, ...] = (back,)
        if not session.operator.is_one_of(SourceKind.XR):
            # In a headset the trainee looks around by turning the head.
            pairs = (ControlName.LEFT, ControlName.RIGHT), (ControlName.UP, ControlName.DOWN)
            turn = self.say("hint.turn_view")
            hints = (*(Hint(session.operator.pair_label(*pair), turn) for pair in pairs), back)
        return Screen(
            instruction=ScreenMessage(self.content().title),
            hints=hints,
            language=session.preferences.language,
            errors=tuple(errors),
            is_head_clear=self._has_lines,
        )

    def pressed(self, control: ControlName) -> bool:
        if control not in _TURNS:
            return False
        session = self.session
        camera = session.scenario.cameras[session.state.camera]
        session.view.control.turn(camera, *_TURNS[control], 1.0)
        return True


def error_arrow(fiducial: Vector, touch: Vector) -> ErrorArrow:
    error = subtract(touch, fiducial)
    tone = error_tone(MM_PER_M * length(error))
    return ErrorArrow(fiducial, add(fiducial, scale(error, LONGER)), tone)


def error_tone(error_mm: float) -> Tone:
    tone = Tone.ERROR if error_mm >= POOR_MM else Tone.WARNING
    return Tone.GOOD if error_mm <= GOOD_MM else tone


class ReplayPage(SessionPage):
    """Waits for the recorded trial, and replays it for the operator."""

    name = "replay"

    def __init__(
        self, session: TrainingSession, loading: TrialLoading, begins_at_worst: bool
    ) -> None:
        super().__init__(session)
        self.playback: Playback | None = None
        self._loading = loading
        self._begins_at_worst = begins_at_worst
        self._player: Player | None = None

    def content(self) -> PageContent:
        return PageContent(rows=(self.button("back"),), title=self.say("replay.loading"))

    def screen(self) -> Screen | None:
        """Return the screen of the playback, with the plan of a procedure if it was visible."""
        if self._player is None or self.playback is None:
            return None
        session = self.session
        label, pair_label = session.operator.label, session.operator.pair_label
        hints = (
            clickable_hint(session, ControlName.ACCEPT, "hint.play"),
            Hint(pair_label(ControlName.LEFT, ControlName.RIGHT), self.say("hint.seek")),
            clickable_hint(session, ControlName.UP, "hint.worst"),
            clickable_hint(session, ControlName.CAMERA, "hint.camera"),
            Hint(label(ControlName.BACK), self.say("hint.result"), "back"),
        )
        shown = self._player.screen(session.texts, hints, session.preferences.language)
        procedure = self.playback.latest.training.procedure
        if procedure is None or procedure.present is None:
            return shown
        marks = plan_marks(procedure, session.bone_ahead(procedure))
        return replace(shown, errors=marks, is_head_clear=True)

    def advance(self, dt: float) -> None:
        if self.playback is not None:
            self.playback.advance(dt)
        elif self._loading.loaded.done():
            self._begin()

    def pressed(self, control: ControlName) -> bool:
        if self._player is None:
            return False
        self._do(self._player, control)
        return True

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        bindings = self.session.controls.bindings
        if self._player is None or bindings.control(device, name, ControlContext.MENU) is not None:
            return False
        control = replay_control(bindings, device, name)
        if control is not None:
            self._do(self._player, control)
        return True

    def _begin(self) -> None:
        session = self.session
        try:
            trial = self._loading.loaded.result()
        except InputError as error:
            self.back()
            session.complain(str(error))
            return
        self.playback = Playback(trial, session.control_loop.setup)
        self._player = Player(self.playback, self.back)
        self.playback.subscribe(lambda result: session.feel(result.events, result.state.touch))
        if self._begins_at_worst and trial.worst is None:
            session.complain(self.say("replay.no worst"))
        elif self._begins_at_worst:
            self._do(self._player, ControlName.UP)

    def _do(self, player: Player, control: ControlName) -> None:
        player.do(control)
        if control is ControlName.UP and player.playback.trial.worst is not None:
            self.session.view.is_best_wanted = True


MOST_TRIALS = 12
_VERDICTS = {True: "experiment.passed", False: "experiment.failed", None: "experiment.done"}


@page_kind("own-trials")
def own_trials_page(page: SessionPage) -> PageContent:
    session, say = page.session, page.say

    def show(trial_id: str) -> None:
        with session.complaining():
            loading = session.load_trial(trial_id)
            session.pages.open(ReplayPage(session, loading, begins_at_worst=False))

    def row(each: OwnTrial) -> PageRow:
        past = each.past
        is_shown = each.scenario == session.scenario.name and not past.is_aborted
        verdict = say(_VERDICTS[each.is_passed])
        when = each.started_utc[:16].replace("T", " ")
        return page.button(
            f"trial {past.trial_id}",
            partial(show, past.trial_id),
            f"{session.task_title(past.task)} ({when} UTC)",
            value=verdict if past.is_aborted else f"{past.score:.0f} / 100, {verdict}",
            is_enabled=is_shown,
            help=say("own-trials.help" if is_shown else "own-trials.not shown"),
        )

    trainee = session.trainee_id
    trials = reversed(session.history.own(trainee)[-MOST_TRIALS:])
    back = page.button("back", label=say("experiment.back"))
    title = say("own-trials.title", trainee=trainee)
    return PageContent(rows=(*map(row, trials), back), title=title)
