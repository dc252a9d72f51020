"""The commands that clients may send: arguments, effect, answer, and when they are refused.

All that both sides know of a command stands in its entry; what carries it out is a handler of the
simulator. docs/commands.md is made of the entries by `tools/reference_pages.py`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields
from typing import Annotated, Any, Literal, cast

from rastrainer import json_checks, protocol
from rastrainer.errors import InputError
from rastrainer.json_checks import number, numbers, one_of, text, trial_id, whole_number
from rastrainer.json_records import record_fields, record_from_json
from rastrainer.protocol import FINISHED_PHASES, OPEN_PHASES, PROCEDURE_PHASES, Mode, Phase
from rastrainer.study_messages import AnyMode, CurriculumMessage, Skin, StudyStep

_Numbers = tuple[float, ...]
_place = numbers(3, protocol.WORLD_LIMIT_MM, "mm")
_Position = Annotated[_Numbers, _place]
_TrialId = Annotated[str, trial_id]
_Name = Annotated[str, text(40, 0)]
"""Name of a procedure, a method or an assignment; empty for none."""


@dataclass(frozen=True)
class NoArguments:
    """The record of a command without arguments."""


@dataclass(frozen=True)
class HelloArguments:
    """Introduces the client, and sets the rates of its poses."""

    protocol_version: Annotated[int, whole_number(0, 1_000_000), f"now {protocol.PROTOCOL_VERSION}"]
    client: str
    tool_tip_hz: Annotated[float, number(0, 250, "Hz")] = protocol.Rate.TOOL_TIP_HZ
    links_hz: Annotated[float, number(0, 250, "Hz")] = protocol.Rate.LINKS_HZ
    steady: bool = False
    scores: bool = True


@dataclass(frozen=True)
class LoadScenarioArguments:
    """Loads another scenario."""

    folder: Annotated[
        str,
        text(1024),
        "a path, or the name of a scenario that comes with RASTrainer or is in the user's library",
    ]


@dataclass(frozen=True)
class StartTutorialArguments:
    """Opens the [tutorial](views.md#the-tutorial) if the trainee's trial run waits for it.

    3D Slicer sends it before it starts a trial run.
    """

    trainee: Annotated[str, json_checks.pseudonym]
    mode: AnyMode = Mode.DESKTOP.value


class StartDrillArguments(StartTutorialArguments):
    """Opens the trainee's [drill of decisions](views.md#the-drill-of-decisions).

    One that the trainee has not finished goes on at its present case.
    """


@dataclass(frozen=True)
class StartTaskArguments:
    """Starts a trial."""

    task: str
    trainee: Annotated[str, json_checks.pseudonym]
    mode: AnyMode = Mode.DESKTOP.value
    seed: Annotated[
        int | None,
        whole_number(0, 2**63 - 1),
        "of the head's pose; drawn if left out; the record says that a client chose it",
    ] = None
    procedure: Annotated[_Name, "touches only if empty"] = ""
    method: Annotated[
        _Name, "`fiducials`, `landmarks`, `surface` or `landmarks-surface`; fiducials if empty"
    ] = ""
    skin: Annotated[
        Skin,
        "how the [skin shifts](registration-methods.md#the-skin-moves); if empty, as the scenario "
        "specifies",
    ] = field(default_factory=dict)


@dataclass(frozen=True)
class JogArguments:
    """Moves the tip for some time."""

    velocity_mm_s: Annotated[_Numbers, numbers(3, protocol.SPEED_LIMIT_MM_S, "mm/s")]
    frame: Literal["world", "camera", "tool"] = "world"
    duration_s: Annotated[float, number(0, 2, "s")] = 0.1


@dataclass(frozen=True)
class MoveTipToArguments:
    """Moves the tip to a point."""

    position_mm: _Position
    direction: Annotated[_Numbers | None, numbers(3, 1), "of the tool, from A7 to the tip"] = None
    speed_mm_s: Annotated[float, number(0, protocol.SPEED_LIMIT_MM_S, "mm/s")] = 100.0


@dataclass(frozen=True)
class TraceArguments:
    """Begins or ends a stroke over the skin."""

    on: bool


@dataclass(frozen=True)
class UseRegistrationArguments:
    """Shows the plan of a procedure by this registration."""

    trial_id: _TrialId
    matrix: Annotated[_Numbers, numbers(16, 1e6), "WorldToHead, rigid, row by row, in mm"]
    fre_mm: Annotated[float, number(0, 1e6, "mm")]
    expected_tre_mm: Annotated[float, number(0, 1e6, "mm")]


class SubmitRegistrationArguments(UseRegistrationArguments):
    """Submits the trial's registration, which is final from then on."""


@dataclass(frozen=True)
class AlignGuideArguments:
    """Has the robot bring the guide onto the planned line."""

    stand_off_mm: Annotated[float, number(0, protocol.STAND_OFF_LIMIT_MM, "mm")] = 30.0


@dataclass(frozen=True)
class FeedArguments:
    """Moves drill or instrument along the guide."""

    velocity_mm_s: Annotated[
        float, number(-protocol.FEED_LIMIT_MM_S, protocol.FEED_LIMIT_MM_S, "mm/s"), "inward above 0"
    ]
    duration_s: Annotated[float, number(0, 2, "s")] = 0.1


@dataclass(frozen=True)
class AbortArguments:
    """Ends the trial."""

    reason: Annotated[str, one_of(*protocol.COMMANDED_ABORTS)] = protocol.AbortReason.CLIENT.value
    trial_id: Annotated[str | None, trial_id, "refused if a different trial is open now"] = None


@dataclass(frozen=True)
class SetCameraArguments:
    """Chooses the view."""

    camera: Literal["close-up", "far"]


@dataclass(frozen=True)
class TrialScoredArguments:
    """Reports the score of a trial whose registration was submitted."""

    trial_id: _TrialId
    score: Annotated[float, number(0, 100)]
    details: Annotated[Mapping[str, Any], json_checks.plain_object] = field(default_factory=dict)


@dataclass(frozen=True)
class PlanTargetArguments:
    """Shows a planned target or trajectory."""

    position_mm: _Position
    entry_mm: Annotated[_Numbers | None, _place, "the entry point of a trajectory"] = None
    name: str = "target"


@dataclass(frozen=True)
class GetTrialArguments:
    """Reads a trial."""

    trial_id: _TrialId


class AcknowledgeTrialArguments(GetTrialArguments):
    """States that a trial, finished or aborted, that was offered over this connection is stored.

    It is not offered again, not even after a restart.
    """


@dataclass(frozen=True)
class GetJournalArguments:
    """Reads a piece of the journal of a finished trial whose registration was submitted."""

    trial_id: _TrialId
    start: Annotated[int, whole_number(0, protocol.MAX_JOURNAL_BYTES), "in bytes"] = 0


class CommandEntry(str):
    """A command that clients may send: its name, and all that both sides have to know about it.

    Effect, answer and texts in the annotations of the arguments are for docs/commands.md.
    """

    effect: str
    arguments: type[Any]
    answer: str
    refused: Mapping[Phase, str] | None
    """Code of the refusal in each phase in which it is wrong; None if it does not go to the
    simulation."""
    entries: frozenset[str]
    """Kinds of journal entries that show that it was carried out: by them a trial is resumed."""
    is_stateless: bool
    """Whether it does not change the trial. All others are carried out one at a time."""
    is_for_past_trials: bool
    is_for_scorers: bool
    """Whether only clients that register and score trials may send it."""

    def __new__(
        cls,
        name: str,
        about: type[Any] | str,
        answer: str = "",
        *,
        arguments: type[Any] = NoArguments,
        refused: Mapping[Phase, str] | None = None,
        entries: Iterable[str] = (),
        is_stateless: bool = False,
        is_for_past_trials: bool = False,
        is_for_scorers: bool = False,
    ) -> CommandEntry:
        """`about` is the record of its arguments, with the effect as docstring, or the effect."""
        self = super().__new__(cls, name)
        self.arguments = arguments if isinstance(about, str) else about
        self.effect = about if isinstance(about, str) else " ".join(str(about.__doc__).split())
        self.answer, self.refused, self.entries = answer, refused, frozenset(entries)
        self.is_stateless, self.is_for_past_trials = is_stateless, is_for_past_trials
        self.is_for_scorers = is_for_scorers
        return self

    def __reduce__(self) -> tuple[type[str], tuple[str]]:
        """Have copies be plain names."""
        return str, (str(self),)


_NO_TRIAL = {Phase.IDLE: "no trial"}
_PAUSED = {Phase.PAUSED: "is paused"}
_AT_THE_PROCEDURE = {phase: f"{phase.value} now" for phase in PROCEDURE_PHASES}
_ARM_IS_HELD = {
    **_PAUSED,
    **{phase: _AT_THE_PROCEDURE[phase] for phase in (Phase.DRILLING, Phase.INSERTING)},
}
_OUTSIDE_A_TRIAL = {**_NO_TRIAL, **dict.fromkeys(FINISHED_PHASES, "is registered")}
AFTER_THE_TOUCHES = {**_OUTSIDE_A_TRIAL, **_PAUSED, **_AT_THE_PROCEDURE}
_BEFORE_REGISTRATION = {
    **_NO_TRIAL,
    **dict.fromkeys(OPEN_PHASES, "not registered"),
    **_AT_THE_PROCEDURE,
}


def _but_in(*phases: Phase) -> dict[Phase, str]:
    """Return the refusals of a command that belongs to some phases of a procedure."""
    before = dict.fromkeys((Phase.RUNNING, Phase.COMPLETE), "not at the procedure")
    elsewhere = {**AFTER_THE_TOUCHES, **before}
    return {phase: code for phase, code in elsewhere.items() if phase not in phases}


_STATE = "the state of the trial"


def _step(name: str, effect: str, phase: Phase) -> CommandEntry:
    """Return a command that leads a procedure on from a phase."""
    return CommandEntry(name, effect, _STATE, refused=_but_in(phase), entries=("phase",))


class CommandName:
    """The commands; the last three go from the server to its clients."""

    HELLO = CommandEntry(
        "Hello", HelloArguments, "`protocolVersion`, `server`, `version`, the rates and `steady`"
    )
    LIST_TASKS = CommandEntry(
        "ListTasks",
        "Lists what can be trained on.",
        "`scenario`, `title`, `tasks`: `name`, `title`, `complexity`; `procedures`: `name`, "
        "`title`, `kind` (`biopsy`, `dbs`, `seeg`), `trajectories` (names)",
        refused={},
        is_stateless=True,
    )
    LOAD_SCENARIO = CommandEntry("LoadScenario", LoadScenarioArguments, "`name`, `title`")
    START_TUTORIAL = CommandEntry(
        "StartTutorial", StartTutorialArguments, "`isNeeded`; false if there are no views"
    )
    START_DRILL = CommandEntry("StartDrill", StartDrillArguments, "`trialId`, once it has begun")
    START_TASK = CommandEntry(
        "StartTask",
        StartTaskArguments,
        "`trialId`, `phase`, `nextPoint` …",
        refused={
            **dict.fromkeys(OPEN_PHASES, "trial is open"),
            **dict.fromkeys(PROCEDURE_PHASES, "procedure is open"),
        },
        entries=("phase",),
    )
    JOG = CommandEntry("Jog", JogArguments, refused=_ARM_IS_HELD, is_stateless=True)
    MOVE_TIP_TO = CommandEntry(
        "MoveTipTo", MoveTipToArguments, refused=_ARM_IS_HELD, is_stateless=True
    )
    CAPTURE = CommandEntry(
        "Capture",
        "Touches the next point, or the nearest checkpoint.",
        _STATE,
        refused={
            **_OUTSIDE_A_TRIAL,
            **_PAUSED,
            Phase.COMPLETE: "all touched",
            **{p: code for p, code in _AT_THE_PROCEDURE.items() if p is not Phase.VERIFYING},
        },
        entries=("touch", "checkpoint", "rejected"),
    )
    TRACE = CommandEntry(
        "Trace",
        TraceArguments,
        "`on`, `kept` (points so far), `strokes`",
        refused=AFTER_THE_TOUCHES,
        entries=("stroke",),
    )
    UNDO = CommandEntry(
        "Undo",
        "Removes the last touch or stroke.",
        _STATE,
        refused=AFTER_THE_TOUCHES,
        entries=("undo", "stroke"),
    )
    REGISTER = CommandEntry(
        "Register",
        "Ends the touches.",
        _STATE,
        refused={**AFTER_THE_TOUCHES, Phase.RUNNING: "not all touched"},
        entries=("phase",),
    )
    USE_REGISTRATION = CommandEntry(
        "UseRegistration",
        UseRegistrationArguments,
        f"{_STATE}, `registration`; never the truth",
        refused=_but_in(Phase.VERIFYING),
        entries=("phase",),
        is_for_scorers=True,
    )
    ACCEPT_REGISTRATION = _step(
        "AcceptRegistration", "Goes on to the first trajectory.", Phase.VERIFYING
    )
    REGISTER_AGAIN = _step("RegisterAgain", "Starts the touches again.", Phase.VERIFYING)
    ALIGN_GUIDE = CommandEntry(
        "AlignGuide", AlignGuideArguments, refused=_but_in(Phase.ALIGNING), is_stateless=True
    )
    LOCK_GUIDE = _step("LockGuide", "Locks the guide where it is.", Phase.ALIGNING)
    FEED = CommandEntry(
        "Feed", FeedArguments, refused=_but_in(Phase.DRILLING, Phase.INSERTING), is_stateless=True
    )
    RETRACT_DRILL = _step(
        "RetractDrill",
        "Takes the drill out and unlocks the guide, until the drill cuts bone.",
        Phase.DRILLING,
    )
    START_INSERTION = _step(
        "StartInsertion",
        "Puts the instrument into the guide in place of the drill.",
        Phase.DRILLING,
    )
    RELEASE_INSTRUMENT = _step(
        "ReleaseInstrument", "Leaves the instrument where it is.", Phase.INSERTING
    )
    ABORT = CommandEntry("Abort", AbortArguments, "`trialId`", refused=_OUTSIDE_A_TRIAL)
    PAUSE = CommandEntry(
        "Pause",
        "Stops the trial's time, and the arm.",
        _STATE,
        refused={**_OUTSIDE_A_TRIAL, Phase.PAUSED: "already paused", Phase.COMPLETE: "all touched"},
        entries=("phase",),
    )
    RESUME = CommandEntry(
        "Resume",
        "Continues a paused trial.",
        _STATE,
        refused={
            **_OUTSIDE_A_TRIAL,
            **_AT_THE_PROCEDURE,
            Phase.RUNNING: "not paused",
            Phase.COMPLETE: "all touched",
        },
        entries=("phase",),
    )
    SET_CAMERA = CommandEntry("SetCamera", SetCameraArguments, refused={}, is_stateless=True)
    SUBMIT_REGISTRATION = CommandEntry(
        "SubmitRegistration",
        SubmitRegistrationArguments,
        "`trialId`, `headToWorld` (16), `trueTreMm`, `touchErrorsMm`, `skin` (where it has "
        "shifted, with `seed`): the truth, secret until then",
        refused=_BEFORE_REGISTRATION,
        is_for_past_trials=True,
        is_for_scorers=True,
    )
    TRIAL_SCORED = CommandEntry(
        "TrialScored",
        TrialScoredArguments,
        "`trialId`",
        refused=_BEFORE_REGISTRATION,
        is_for_past_trials=True,
        is_for_scorers=True,
    )
    PLAN_TARGET = CommandEntry(
        "PlanTarget",
        PlanTargetArguments,
        "`reachable`, and `reason` (a sentence) if it is not",
        refused=_BEFORE_REGISTRATION,
        is_stateless=True,
    )
    STUDY_STEP = CommandEntry(
        "StudyStep",
        "States the next step that a study requires of a trainee. From then on, the trainee's own "
        "menu starts nothing else, until a `StudyStep` of kind `free`.",
        arguments=StudyStep,
    )
    CURRICULUM = CommandEntry(
        "Curriculum",
        "States where a trainee stands in a [curriculum](how-to/set-a-curriculum.md).",
        arguments=CurriculumMessage,
    )
    GET_TRIAL = CommandEntry(
        "GetTrial",
        GetTrialArguments,
        "`record`, `phase`, `acknowledged`; the truth once a registration is submitted, but never "
        "that of an aborted trial",
        refused=_NO_TRIAL,
        is_stateless=True,
        is_for_past_trials=True,
    )
    GET_JOURNAL = CommandEntry(
        "GetJournal",
        GetJournalArguments,
        "`text`, and `next`, the start of the next piece, or null",
        is_stateless=True,
        is_for_past_trials=True,
        is_for_scorers=True,
    )
    ACKNOWLEDGE_TRIAL = CommandEntry(
        "AcknowledgeTrial",
        AcknowledgeTrialArguments,
        "`trialId`",
        is_for_past_trials=True,
        is_for_scorers=True,
    )
    TRIAL_COMPLETED = "TrialCompleted"
    TRIAL_ABORTED = "TrialAborted"
    STEP_ANSWERED = "StepAnswered"


COMMANDS: Mapping[str, CommandEntry] = {
    each: each for each in vars(CommandName).values() if isinstance(each, CommandEntry)
}
"""Every command that a client may send, by its name."""


def check_arguments(command: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    if command not in COMMANDS:
        known, given = ", ".join(COMMANDS), json.dumps(str(command)[:40])
        raise InputError(f"The command {given} is unknown; known are {known}.")
    kind = COMMANDS[command].arguments
    if arguments and not fields(kind):
        raise InputError(f"{command} takes no arguments.")
    record = record_from_json(kind, arguments, command, only_known=True)
    return {each.key: getattr(record, each.name) for each in record_fields(cast("Any", kind))}


def decode_json_object(body: str) -> dict[str, Any]:
    """Return the JSON object in a command's body; an empty body is an empty object."""
    return json_checks.decode_message_object(body or "{}", "The command's body")


def decode_answer_object(body: str) -> dict[str, Any]:
    """Return the JSON object in an answer of the simulator, such as a trial's record."""
    most = json_checks.MAX_RECORD_VALUES
    return json_checks.decode_message_object(body or "{}", "The simulator's message", most)


def deflection(value: float) -> float:
    """Return the push of a stick or key, limited to −1…1; 0 for a number that is not finite.

    `max(-1, min(1, value))` would make full speed of a value that is not a number.
    """
    return max(-1.0, min(1.0, value)) if math.isfinite(value) else 0.0
