"""The section Procedure: what follows the registration of a trial, step by step, and its errors."""

from __future__ import annotations

from functools import partial
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.number_text import fixed
from rastrainer.procedure.errors import TrajectoryErrors
from rastrainer.protocol import Phase
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.training_logic import TrialStatus
from rastrainer.slicer.settings import SLICES_LIE_ALONG
from rastrainer.slicer.translation import _
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.widgets.controls import bind, fillTable, numberOrDash, setEnabled, setText

FEED_MM, FEED_MM_S = 1.0, 2.0
"""How far one press of a button feeds drill or instrument, and how fast."""
_VERIFY, _ALIGN = (Phase.VERIFYING,), (Phase.ALIGNING,)
_DRILL, _INSERT = (Phase.DRILLING,), (Phase.INSERTING,)
_FEED = {"velocityMmS": FEED_MM_S, "durationS": FEED_MM / FEED_MM_S}
STEPS: dict[str, tuple[Any, ...]] = {
    "acceptButton": (_VERIFY, CommandName.ACCEPT_REGISTRATION),
    "registerAgainButton": (_VERIFY, CommandName.REGISTER_AGAIN),
    "alignButton": (_ALIGN, CommandName.ALIGN_GUIDE),
    "lockButton": (_ALIGN, CommandName.LOCK_GUIDE),
    "advanceButton": (_DRILL + _INSERT, CommandName.FEED, _FEED),
    "withdrawButton": (_DRILL + _INSERT, CommandName.FEED, {**_FEED, "velocityMmS": -FEED_MM_S}),
    "retractDrillButton": (_DRILL, CommandName.RETRACT_DRILL),
    "startInsertionButton": (_DRILL, CommandName.START_INSERTION),
    "releaseButton": (_INSERT, CommandName.RELEASE_INSTRUMENT),
}
"""The phases that each button belongs to, and the command that it sends, with arguments."""
WHEN = {
    Phase.VERIFYING: _("while the registration is verified"),
    Phase.ALIGNING: _("while the guide is aligned"),
    Phase.DRILLING: _("while the skull is drilled"),
    Phase.INSERTING: _("while the instrument is inserted"),
}


class ProcedurePanel(Panel):
    """The section Procedure."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.procedure
        bind(ui.slicesAlongCheckBox, "checked", session.settings, SLICES_LIE_ALONG)
        ui.slicesAlongCheckBox.connect("toggled(bool)", lambda _checked: session.woken.emit())
        for button, (_phases, *command) in STEPS.items():
            send = partial(self._logic.command, *command)
            connectClick(getattr(ui, button), send, _("The command was not sent."))
        ui.procedureErrorsTable.connect("itemSelectionChanged()", self._jumpToTarget)
        section, connection = ui.procedureCollapsibleButton, session.link.statusChanged
        self.showWhileOpen(section, self.showState, self._logic.changed, connection)
        self.listen(
            (self._logic.answered, partial(setText, ui.procedureMessageText)),
            (self._logic.outcomeChanged, self._showOutcome),
        )
        self._showOutcome()
        self.showState()

    def showState(self, *_arguments: Any) -> None:
        ui, status, isFailed = self._ui, self._logic.status, self._logic.isRegistrationFailed
        isConnected = self._session.link.status.isConnected
        setText(ui.procedureStateText, stateText(status, isConnected))
        advice = instruction(status)
        if isFailed:
            advice = _("The touches could not be registered: have all points touched again.")
        setText(ui.procedureInstructionText, advice if isConnected else "")
        for button, (phases, *_command) in STEPS.items():
            isReady = status.procedure.registrationInUse or Phase.VERIFYING not in phases
            # If registration fails, the only remedy is to touch again.
            isReady |= isFailed and button == "registerAgainButton"
            isNow = status.isProcedureUnderWay and status.phase in phases
            when = _(" or ").join(WHEN[phase] for phase in phases)
            reason = _("Only {when}.").format(when=when)
            if isNow and not isReady:
                reason = _("The touches are being registered.")
            if not isConnected:
                reason = _("Connect to the simulator first.")
            setEnabled(getattr(ui, button), isConnected and isNow and isReady, reason)

    def _showOutcome(self) -> None:
        ui, outcome = self._ui, self._logic.outcome
        each = () if outcome is None else outcome.analysis.trajectories
        fillTable(ui.procedureErrorsTable, map(_row, each), [_tip(errors) for errors in each])
        ui.procedureErrorsTable.visible = outcome is not None
        setText(ui.procedureScoreText, "" if outcome is None else scoreText(outcome))

    def _jumpToTarget(self) -> None:
        row = self._ui.procedureErrorsTable.currentRow()
        if self._logic.outcome is not None and 0 <= row < len(self._logic.lines):
            self._session.slices.show(self._logic.lines[row].planned[1])


def stateText(status: TrialStatus, isConnected: bool) -> str:
    """Return the state of the procedure, with the numbers that the trainee also sees."""
    if not isConnected:
        return _("Connect to the simulator first.")
    procedure = status.procedure
    if not procedure.name:
        return _("No trial with a procedure is open: choose one in the section Training.")
    line = _("{name}, line {number} of {count}").format(
        name=procedure.name, number=procedure.trajectory + 1, count=procedure.trajectories
    )
    if status.phase == Phase.ALIGNING.value and procedure.entryDistanceMm is not None:
        return _(
            "{line}: the guide is {entry} mm and {angle}° off, {standOff} mm before the entry."
        ).format(
            line=line,
            entry=fixed(procedure.entryDistanceMm, 2),
            angle=fixed(procedure.angleDeg or 0.0, 2),
            standOff=fixed(procedure.standOffMm or 0.0, 1),
        )
    if status.phase in (Phase.DRILLING.value, Phase.INSERTING.value):
        return _("{line}: {depth} mm beyond the guide.").format(
            line=line, depth=fixed(procedure.feedMm, 1)
        )
    return line if procedure.trajectories else procedure.name


NEXT = {
    Phase.VERIFYING.value: _(
        "Touch checkpoints to verify the registration; then accept it, or register again. "
        "An offset common to all touches does not show there."
    ),
    Phase.ALIGNING.value: _(
        "Bring the guide onto the planned line, by hand or by the robot; then lock it."
    ),
    Phase.DRILLING.value: _(
        "Drill through the skull, and stop past its inner table; then insert the instrument."
    ),
    Phase.INSERTING.value: _("Advance the instrument to the target, and release it there."),
}


def instruction(status: TrialStatus) -> str:
    """Return the next thing to do in the procedure, if any."""
    text = NEXT[status.phase] if status.isProcedureUnderWay else ""
    if not text or status.phase != Phase.VERIFYING.value:
        return text
    if not status.procedure.registrationInUse:
        return _("The touches are being registered.")
    checked = _("No checkpoint has been touched.")
    if status.procedure.lastCheckMm is not None:
        mm = fixed(status.procedure.lastCheckMm, 1)
        checked = _("The last checkpoint was {error} mm off.").format(error=mm)
    return f"{checked} {text}"


def scoreText(outcome: ProcedureOutcome) -> str:
    score, analysis = outcome.score, outcome.analysis
    text = _("Score of the procedure: {score} of 100 (version {version}).")
    said = [text.format(score=fixed(score.score, 1), version=score.version)]
    hit = _("{trajectory} hit {structure}.")
    said += [hit.format(trajectory=line, structure=name) for line, name in analysis.hits]
    if analysis.self_aligned:
        text = _("The robot aligned {count} of {lines} lines: only their depth is by hand.")
        said.append(text.format(count=analysis.self_aligned, lines=len(analysis.trajectories)))
    text = _("{trajectory} missed the skull.")
    said += [text.format(trajectory=line) for line in analysis.missed_bone]
    if not score.acceptable:
        said.append(_("Not acceptable: an error is beyond its limit, or a structure was hit."))
    return " ".join(said)


def _row(errors: TrajectoryErrors) -> tuple[str, ...]:
    target, entry = errors.target_point_error, errors.entry_point_error
    split = target.mm, target.by_registration_mm, target.by_hand_mm
    numbers = (*split, entry.mm, errors.angular_deviation_deg)
    return errors.trajectory, *(fixed(number, 2) for number in numbers)


def _tip(errors: TrajectoryErrors) -> str:
    error = errors.entry_point_error
    entry = _("Entry: registration {shown} mm, hand {hand} mm.")
    angle = _("Angle: registration {shown}°, hand {hand}°.")
    if errors.self_aligned:
        entry = _("Entry: registration {shown} mm, robot {hand} mm.")
        angle = _("Angle: registration {shown}°, robot {hand}°.")
    deviation = _(
        "Radial error {radial} mm, depth error {depth} mm (registration {shown}, hand {hand})."
    )
    kept = _("{mm} mm to {name}.")
    lines = [
        deviation.format(
            radial=fixed(errors.radial_error.mm, 2),
            depth=fixed(errors.depth_error_mm, 2),
            shown=fixed(errors.depth_error_by_registration_mm, 2),
            hand=fixed(errors.depth_error_by_hand_mm, 2),
        ),
        entry.format(shown=fixed(error.by_registration_mm, 2), hand=fixed(error.by_hand_mm, 2)),
        angle.format(
            shown=fixed(errors.angular_deviation_by_registration_deg, 2),
            hand=fixed(errors.angular_deviation_by_hand_deg, 2),
        ),
        _("Plunge depth {plunge}.").format(plunge=numberOrDash(errors.plunge_mm, 1, "mm")),
        *(kept.format(mm=fixed(mm, 1), name=name) for name, mm in errors.kept_mm.items()),
    ]
    return "\n".join(lines)
