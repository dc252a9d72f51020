"""Texts and controls from the registration to the placed instrument."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

from rastrainer.commands import CommandName
from rastrainer.number_text import clock
from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.arm_screen import ArmScreen
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.plan_marks import ball, plan_marks
from rastrainer_simulator.flow.session.session import SessionPage
from rastrainer_simulator.flow.trial_screen import TrialScreen
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from rastrainer_simulator.presentation.screen import (
    DepthRuler,
    ErrorArrow,
    Hint,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.training.feed import FeedLayer
from rastrainer_simulator.trial_state import ProcedureState
from rastrainer_simulator.vectors import dot, subtract

PAST_TARGET_MM = 0.5
"""Farther past the planned target, drill or instrument has to be drawn back."""
FED = (Phase.DRILLING, Phase.INSERTING)
_FELT: Mapping[str, Tone] = {
    FeedLayer.BONE.value: Tone.PLAIN,
    FeedLayer.THROUGH.value: Tone.WARNING,
    FeedLayer.BLOCKED.value: Tone.ERROR,
}
"""Layers that a hand feels through the drill or the instrument, and their tones."""


@dataclass(eq=False)
class ProcedureScreen(ArmScreen):
    """The instructions, the figures and the controls of the phases after the touches."""

    _trial_screen: TrialScreen

    @property
    def is_open(self) -> bool:
        training = self._session.training
        stage = None if training.procedure is None else training.procedure.stage
        return training.phase in PROCEDURE_PHASES or (
            training.phase is Phase.PAUSED and stage in PROCEDURE_PHASES
        )

    def pressed(self, control: ControlName) -> None:
        """Carry out a control: Undo opens the phase's menu, and so does Touch except at first."""
        session = self._session
        is_verifying = session.training.phase is Phase.VERIFYING
        if control is ControlName.CAMERA:
            self._change_camera()
        elif control is ControlName.TOUCH and is_verifying:
            session.do(CommandName.CAPTURE)
        elif control in (ControlName.TOUCH, ControlName.UNDO):
            session.pages.open(procedure_page(session))
        else:
            self._trial_screen.pressed(control)

    def open_menu(self) -> None:
        self._trial_screen.open_menu()

    def warnings(self) -> tuple[ScreenMessage, ...]:
        session, training = self._session, self._session.training
        if training.phase is Phase.VERIFYING and self._procedure.registration is None:
            # Why the touches are not registered yet, if that will not change by itself.
            scorer = session.local_scorer
            if scorer is not None and scorer.problem:
                return (self._message("waiting.problem", Tone.ERROR, reason=scorer.problem),)
            if scorer is None and not session.services.is_slicer_connected():
                return (self._message("warning.nobody registers", Tone.WARNING),)
            return ()
        if training.phase not in FED:
            return super().warnings()
        ruler = self._ruler()
        past = 0.0 if ruler is None else MM_PER_M * session.state.feed - ruler.target_mm
        if past > PAST_TARGET_MM:
            return (self._message("warning.past target", Tone.ERROR, past=past),)
        if self._arm.layer not in _FELT:
            return ()
        return (self._message(f"felt.{self._arm.layer}", _FELT[self._arm.layer]),)

    def _status(self) -> tuple[str, ...]:
        session, say = self._session, self._session.say
        procedure = self._procedure
        facts = [session.task_title(session.training.task)]
        if procedure.present is not None:
            number, count = procedure.trajectory + 1, len(procedure.trajectories)
            facts.append(say("status.line", number=number, count=count))
        if procedure.checkpoints and procedure.stage is Phase.VERIFYING:
            last = procedure.checkpoints[-1]
            error_mm = MM_PER_M * last.error
            facts.append(say("status.checkpoint", name=last.name, error=error_mm))
        took = clock(session.state.procedure_time or 0.0)
        facts.append(say("status.procedure time", time=took))
        return (*facts, *self._figures())

    def screen(self) -> Screen:
        """The trainee looks into the head as soon as the guide is being aligned."""
        phase = self._session.training.phase
        names = {
            ControlName.TOUCH: "hint.checkpoint" if phase is Phase.VERIFYING else "hint.next step",
            ControlName.UNDO: "hint.judge",
            ControlName.FINE: "hint.fine",
            ControlName.CAMERA: "hint.front",
            ControlName.MENU: "hint.menu",
        }
        if phase is not Phase.VERIFYING:
            del names[ControlName.UNDO]
        return self._shown(
            self._instructed(Tone.WARNING if self._is_refused else Tone.GOOD),
            self._status(),
            self._hints(self._moving_hints(phase), names, can_tilt=phase is Phase.ALIGNING),
            errors=self._marks(),
            is_head_clear=self._procedure.present is not None,
            ruler=self._ruler(),
        )

    def _marks(self) -> tuple[ErrorArrow, ...]:
        session, procedure = self._session, self._procedure
        if procedure.stage is Phase.VERIFYING:
            touched = {each.name for each in procedure.checkpoints}
            return tuple(
                ball(
                    session.truly_in_world(each.position_ras),
                    Tone.GOOD if each.name in touched else Tone.WARNING,
                    each.name,
                )
                for each in session.scenario.procedure(procedure.name).checkpoints
            )
        return plan_marks(procedure, session.bone_ahead(procedure))

    def _ruler(self) -> DepthRuler | None:
        """Return the scale along the axis of a locked guide; None before it is locked."""
        procedure, say = self._procedure, self._session.say
        if procedure.stage not in FED or procedure.present is None:
            return None
        guide, line = procedure.present.guide, procedure.present.line
        bone = self._session.bone_ahead(procedure)
        if guide is None:
            return None
        begin = MM_PER_M * dot(subtract(line.entry, guide.tip), guide.direction)
        target = MM_PER_M * dot(subtract(line.target, guide.tip), guide.direction)
        along = dot(line.direction, guide.direction)
        inner = None if bone is None or bone.inner_mm is None else begin + along * bone.inner_mm
        return DepthRuler(
            begin,
            None if bone is None else begin + along * bone.outer_mm,
            inner,
            target,
            tuple(say(f"ruler.{name}") for name in ("entry", "outer", "inner", "target")),
        )

    @property
    def _procedure(self) -> ProcedureState:
        procedure = self._session.training.procedure
        assert procedure is not None, "the screen is of a procedure"
        return procedure

    def _figures(self) -> tuple[str, ...]:
        state, say = self._session.state, self._session.say
        alignment, ruler = state.alignment, self._ruler()
        if ruler is not None:
            depth = MM_PER_M * state.feed
            is_drill = self._procedure.stage is Phase.DRILLING
            goal, to = ruler.target_mm, "target"
            if is_drill and ruler.inner_mm is not None:
                goal, to = ruler.inner_mm, "inner"
            if depth > goal:
                return (say(f"status.past {to}", past=depth - goal),)
            return (say(f"status.to {to}", left=goal - depth),)
        if alignment is None:
            return ()
        return (
            say("status.entry", distance=MM_PER_M * alignment.entry_distance),
            say("status.angle", angle=math.degrees(alignment.angle)),
            say("status.stand off", distance=MM_PER_M * alignment.stand_off),
        )

    def _moving_hints(self, phase: Phase) -> tuple[Hint, ...]:
        """Return the functions of the sticks; in a headset only those not drawn in the hands."""
        operator, say = self._session.operator, self._session.say
        if phase in FED:
            return (operator.hint("hint.feed", ControlName.MOVE_DOWN, ControlName.MOVE_UP),)
        is_aligning = phase is Phase.ALIGNING
        if operator.is_one_of(SourceKind.XR):
            return (Hint(say("headset.tilt"), say("hint.tilt")),) if is_aligning else ()
        turning = (
            operator.hint("hint.turn", ControlName.TURN_LEFT, ControlName.TURN_RIGHT),
            operator.hint("hint.tilt", ControlName.TURN_DOWN, ControlName.TURN_UP),
        )
        return (*self._movement_hints(), *(turning if is_aligning else ()))


STAND_OFF_MM = 30.0
"""Distance of the guide's tip from the entry when the robot aligns it: near, but off the skin."""
_STEPS: Mapping[Phase, Mapping[str, str]] = {
    Phase.VERIFYING: {
        "accept": CommandName.ACCEPT_REGISTRATION,
        "again": CommandName.REGISTER_AGAIN,
    },
    Phase.ALIGNING: {"lock": CommandName.LOCK_GUIDE, "align": CommandName.ALIGN_GUIDE},
    Phase.DRILLING: {"insert": CommandName.START_INSERTION, "retract": CommandName.RETRACT_DRILL},
    Phase.INSERTING: {"release": CommandName.RELEASE_INSTRUMENT},
}
"""Commands of each phase by the names of their items."""


@page_kind("procedure")
def procedure_page(page: SessionPage) -> PageContent:
    """Show the actions of the present phase besides moving the tool; none where it has ended."""
    session, training = page.session, page.session.training
    steps = _STEPS.get(training.phase, {})
    can_align = session.control_loop.setup.settings.procedure.self_alignment

    def carry_out(name: str) -> None:
        page.back()
        session.do(steps[name], {"standOffMm": STAND_OFF_MM} if name == "align" else {})

    def step(name: str) -> PageRow:
        procedure = training.procedure
        waits = name == "accept" and (procedure is None or procedure.registration is None)
        help_ = page.say("procedure.waits" if waits else f"procedure.{name} help")
        return page.button(name, partial(carry_out, name), is_enabled=not waits, help=help_)

    names = [name for name in steps if name != "align" or can_align]
    alignment = session.state.alignment
    is_far = alignment is not None and not alignment.is_exact
    key = f"procedure.title.{training.phase.value}"
    title = page.say(key) if names else session.task_title(training.task)
    said = (session.texts.again(training.instruction),)
    rows = (*map(step, names), page.button("work"))
    return PageContent(said, rows=rows, title=title, first="align" if is_far else "")
