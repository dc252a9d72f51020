"""The contract between the simulator and its clients: device names, commands, phases, limits.

Both sides import this file, so they cannot diverge. `rastrainer.igtl` defines the bytes.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Mapping
from enum import Enum
from typing import Any

from rastrainer.errors import InputError
from rastrainer.finite_json import MAX_RECORD_VALUES, decode_message_object
from rastrainer.json_checks import (
    Argument,
    checked_keys,
    number,
    numbers,
    one_of,
    plain_object,
    pseudonym,
    text,
    texts,
    trial_id,
    whole_number,
    yes_or_no,
)

PROTOCOL_VERSION = 2
DEFAULT_HOST = "127.0.0.1"
DEFAULT_PORT = 18944
DEFAULT_VIEW_PORT = 18945
FIDUCIAL_COUNT = 15
TRIAL_RUN = "trial-run"
MIN_TRACE_POINTS, MAX_TRACE_POINTS = 30, 500
"""Of a trace over the skin: fewer do not hold a registration, more add next to nothing."""
TRACE_SPACING_MM = 1.0
"""How far the tip moves from one point of a trace to the next."""


class DeviceName:
    """OpenIGTLink device names of what the server sends; each becomes the name of a MRML node."""

    TOOL_TIP_TO_WORLD = "ToolTipToWorld"
    INSTRUMENT_TIP_TO_WORLD = "InstrumentTipToWorld"
    LINK_TO_WORLD = tuple(f"Link{i}ToWorld" for i in range(8))
    SIM_STATE = "SimState"
    CAPTURED_POINTS = "CapturedPoints"
    SIM_SERVER = "SimServer"
    COMMAND = "command"


class Rate:
    """How often each device is sent: poses and state in simulated time, others in wall time.

    Poses and state are sent at most this often, and only when changed.
    """

    TOOL_TIP_HZ = 60.0
    LINKS_HZ = 30.0
    STATE_HZ = 30.0
    HEARTBEAT_HZ = 1.0
    OFFER_PERIOD_S = 2.0


class Phase(str, Enum):
    """The state of a trial."""

    IDLE = "idle"
    RUNNING = "running"
    PAUSED = "paused"
    COMPLETE = "complete"
    VERIFYING = "verifying"
    ALIGNING = "aligning"
    DRILLING = "drilling"
    INSERTING = "inserting"
    REGISTERED = "registered"
    SCORED = "scored"


PROCEDURE_PHASES = (Phase.VERIFYING, Phase.ALIGNING, Phase.DRILLING, Phase.INSERTING)
"""What follows the touches in a trial with a procedure; `aligning` to `inserting` come once for
each planned trajectory."""
OPEN_PHASES = (Phase.RUNNING, Phase.PAUSED, Phase.COMPLETE, *PROCEDURE_PHASES)
"""A trial that is running, paused, or not registered and delivered yet."""
FINISHED_PHASES = (Phase.REGISTERED, Phase.SCORED)


class AbortReason(str, Enum):
    """Why a trial ended without being registered."""

    TRAINEE = "trainee"
    CLIENT = "client"
    PRACTICE_OVER = "practice over"
    NOT_RESUMED = "not gone on with"


COMMANDED_ABORTS = (AbortReason.TRAINEE, AbortReason.CLIENT, AbortReason.PRACTICE_OVER)
"""In the simulator's menu, by a client's command, or at the end of a trial run's time. The other
reason is for a trial interrupted by the end of the simulator and not resumed before another."""
MIN_ABORTED_S = 10.0
"""An aborted trial without any touch is kept if it took longer than this."""


class Mode(str, Enum):
    """How the trainee sees the scene; the study compares them."""

    DESKTOP = "desktop"
    HMD = "hmd"


class TouchRule(str, Enum):
    """Which touch counts: only on the skin, or, as in the paper, anywhere near the fiducial."""

    ON_SKIN = "on skin"
    WITHIN_RADIUS = "within radius"


class Guidance(str, Enum):
    """How the trainee is guided to the next point.

    `WORDS`: distance and directions in words, and the arrow. `ARROW`: an arrow toward a point that
    is out of sight. `FADING`: words in the trial run, the arrow in the first two tasks, then none.
    """

    FADING = "fading"
    WORDS = "words"
    ARROW = "arrow"
    NONE = "none"


class GhostRule(str, Enum):
    """Which earlier trial of the same task is shown beside the arm.

    `OWN`: the trainee's own best acceptable one. `EXPERT`: that of the expert whom the simulator's
    settings name.
    """

    OFF = "off"
    OWN = "own best"
    EXPERT = "expert"


class TutorialRule(str, Enum):
    """Whether the tutorial comes before the trial run.

    `REQUIRED`: the trial run waits for it. `OPTIONAL`: trainees may leave it out. `SKIPPED`: there
    is none.
    """

    REQUIRED = "required"
    OPTIONAL = "optional"
    SKIPPED = "skipped"


class StepKind(str, Enum):
    """Kind of a step in a study."""

    QUESTIONNAIRE = "questionnaire"
    TRIAL_RUN = "trial-run"
    TRIAL = "trial"
    BREAK = "break"


class GoalKind(str, Enum):
    """When an assignment of a curriculum is reached.

    `SCORE`: some trials in a row pass. `COMPETENT`: its trials show competence by LC-CUSUM.
    """

    SCORE = "score"
    COMPETENT = "competent"


class AssignmentState(str, Enum):
    """Where a trainee stands with an assignment: `LOCKED` waits for others to be reached."""

    LOCKED = "locked"
    OPEN = "open"
    REACHED = "reached"


MAX_ASSIGNMENTS, MAX_GATES, MAX_GOAL_TRIALS = 24, 6, 50
"""Of a curriculum: assignments, how many one waits for, and trials in a row."""
ALL_DONE, FREE, REPEAT = "all-done", "free", "repeat"
"""Instead of a step: none is left, the trainee follows no study, or the step's trial was aborted
and needs a reason to be repeated."""


class Proximity(str, Enum):
    """How near the tool is to the head; `proximity` means within the 20 mm sphere."""

    FREE = "free"
    PROXIMITY = "proximity"
    CONTACT = "contact"


class CommandName:
    """Names of the commands; the last three go from the server to its clients."""

    HELLO = "Hello"
    LIST_TASKS = "ListTasks"
    LOAD_SCENARIO = "LoadScenario"
    START_TUTORIAL = "StartTutorial"
    START_TASK = "StartTask"
    JOG = "Jog"
    MOVE_TIP_TO = "MoveTipTo"
    CAPTURE = "Capture"
    TRACE = "Trace"
    UNDO = "Undo"
    REGISTER = "Register"
    USE_REGISTRATION = "UseRegistration"
    ACCEPT_REGISTRATION = "AcceptRegistration"
    REGISTER_AGAIN = "RegisterAgain"
    ALIGN_GUIDE = "AlignGuide"
    LOCK_GUIDE = "LockGuide"
    FEED = "Feed"
    RETRACT_DRILL = "RetractDrill"
    START_INSERTION = "StartInsertion"
    RELEASE_INSTRUMENT = "ReleaseInstrument"
    ABORT = "Abort"
    PAUSE = "Pause"
    RESUME = "Resume"
    SET_CAMERA = "SetCamera"
    SUBMIT_REGISTRATION = "SubmitRegistration"
    TRIAL_SCORED = "TrialScored"
    PLAN_TARGET = "PlanTarget"
    STUDY_STEP = "StudyStep"
    CURRICULUM = "Curriculum"
    GET_TRIAL = "GetTrial"
    ACKNOWLEDGE_TRIAL = "AcknowledgeTrial"
    TRIAL_COMPLETED = "TrialCompleted"
    TRIAL_ABORTED = "TrialAborted"
    STEP_ANSWERED = "StepAnswered"


SPEED_LIMIT_MM_S = 500.0
WORLD_LIMIT_MM = 5000.0
STAND_OFF_LIMIT_MM = 80.0
SKIN_LIMIT_MM = 20.0
SKIN_KEYS = ("shiftMm", "indentationMm")
"""The farthest that the guide's tip may be from the skin, along its axis, when it is locked."""
FEED_LIMIT_MM_S = 50.0
"""Of `Feed`; drill and instrument have lower limits of their own."""


def skin_amounts(value: Any) -> dict[str, float]:
    """Accept how far the skin shifts (RMS) and is indented, mm; what is left out is 0.

    Raises:
        ValueError: anything else; the words follow "must be".
    """
    check = number(0, SKIN_LIMIT_MM)
    with contextlib.suppress(ValueError):
        if isinstance(value, Mapping) and set(value) <= set(SKIN_KEYS):
            return {key: check(amount) for key, amount in value.items()}
    raise ValueError(
        f"an object of {' and '.join(SKIN_KEYS)}, each a number from 0 to {SKIN_LIMIT_MM:g} mm"
    )


_ASSIGNMENT: Mapping[str, Argument] = {
    "name": Argument(text(40)),
    "task": Argument(text(40)),
    "scenario": Argument(text(40, 0), ""),
    "mode": Argument(one_of("", *(mode.value for mode in Mode)), ""),
    "method": Argument(text(40, 0), ""),
    "procedure": Argument(text(40, 0), ""),
    "goal": Argument(one_of(*(kind.value for kind in GoalKind))),
    "state": Argument(one_of(*(state.value for state in AssignmentState))),
    "done": Argument(whole_number(0, 100), 0),
    "needed": Argument(whole_number(1, 100)),
    "mark": Argument(number(0, 100), 0.0),
    "played": Argument(whole_number(0, 1_000_000), 0),
    "missing": Argument(texts(0, MAX_GATES), ()),
    "weakest": Argument(text(20, 0), ""),
}


def told_assignments(value: Any) -> tuple[dict[str, Any], ...]:
    """Accept a list of where a trainee stands with each assignment; what is left out is default.

    Raises:
        ValueError: anything else; the words follow "must be".
        InputError: a key of an assignment is unknown, missing or out of range.
    """
    if not isinstance(value, list) or len(value) > MAX_ASSIGNMENTS:
        raise ValueError(f"a list of up to {MAX_ASSIGNMENTS} assignments")
    for each in value:
        if isinstance(each, Mapping) and not set(each) <= set(_ASSIGNMENT):
            raise ValueError(f"a list of assignments, each an object of {', '.join(_ASSIGNMENT)}")
    return tuple(checked_keys(each, _ASSIGNMENT, "An assignment") for each in value)


_REGISTRATION: Mapping[str, Argument] = {
    "trialId": Argument(trial_id),
    "matrix": Argument(numbers(16, 1e6)),
    "freMm": Argument(number(0, 1e6, "mm")),
    "expectedTreMm": Argument(number(0, 1e6, "mm")),
}

COMMAND_ARGUMENTS: Mapping[str, Mapping[str, Argument]] = {
    CommandName.HELLO: {
        "protocolVersion": Argument(whole_number(0, 1_000_000)),
        "client": Argument(text()),
        "toolTipHz": Argument(number(0, 250, "Hz"), Rate.TOOL_TIP_HZ),
        "linksHz": Argument(number(0, 250, "Hz"), Rate.LINKS_HZ),
        "steady": Argument(yes_or_no, False),
        "scores": Argument(yes_or_no, True),
    },
    CommandName.LIST_TASKS: {},
    CommandName.LOAD_SCENARIO: {"folder": Argument(text(1024))},
    CommandName.START_TUTORIAL: {
        "trainee": Argument(pseudonym()),
        "mode": Argument(one_of(*(mode.value for mode in Mode)), Mode.DESKTOP.value),
    },
    CommandName.START_TASK: {
        "task": Argument(text()),
        "trainee": Argument(pseudonym()),
        "mode": Argument(one_of(*(mode.value for mode in Mode)), Mode.DESKTOP.value),
        "seed": Argument(whole_number(0, 2**63 - 1), None),
        "procedure": Argument(text(40, 0), ""),
        "method": Argument(text(40, 0), ""),
        "skin": Argument(skin_amounts, {}),
    },
    CommandName.JOG: {
        "velocityMmS": Argument(numbers(3, SPEED_LIMIT_MM_S, "mm/s")),
        "frame": Argument(one_of("world", "camera", "tool"), "world"),
        "durationS": Argument(number(0, 2, "s"), 0.1),
    },
    CommandName.MOVE_TIP_TO: {
        "positionMm": Argument(numbers(3, WORLD_LIMIT_MM, "mm")),
        "direction": Argument(numbers(3, 1), None),
        "speedMmS": Argument(number(0, SPEED_LIMIT_MM_S, "mm/s"), 100.0),
    },
    CommandName.CAPTURE: {},
    CommandName.TRACE: {"on": Argument(yes_or_no)},
    CommandName.UNDO: {},
    CommandName.REGISTER: {},
    CommandName.USE_REGISTRATION: _REGISTRATION,
    CommandName.ACCEPT_REGISTRATION: {},
    CommandName.REGISTER_AGAIN: {},
    CommandName.ALIGN_GUIDE: {"standOffMm": Argument(number(0, STAND_OFF_LIMIT_MM, "mm"), 30.0)},
    CommandName.LOCK_GUIDE: {},
    CommandName.FEED: {
        "velocityMmS": Argument(number(-FEED_LIMIT_MM_S, FEED_LIMIT_MM_S, "mm/s")),
        "durationS": Argument(number(0, 2, "s"), 0.1),
    },
    CommandName.RETRACT_DRILL: {},
    CommandName.START_INSERTION: {},
    CommandName.RELEASE_INSTRUMENT: {},
    CommandName.ABORT: {
        "reason": Argument(
            one_of(*(reason.value for reason in COMMANDED_ABORTS)), AbortReason.CLIENT.value
        ),
        "trialId": Argument(trial_id, None),
    },
    CommandName.PAUSE: {},
    CommandName.RESUME: {},
    CommandName.SET_CAMERA: {"camera": Argument(one_of("close-up", "far"))},
    CommandName.SUBMIT_REGISTRATION: _REGISTRATION,
    CommandName.TRIAL_SCORED: {
        "trialId": Argument(trial_id),
        "score": Argument(number(0, 100)),
        "details": Argument(plain_object, {}),
    },
    CommandName.PLAN_TARGET: {
        "positionMm": Argument(numbers(3, WORLD_LIMIT_MM, "mm")),
        "entryMm": Argument(numbers(3, WORLD_LIMIT_MM, "mm"), None),
        "name": Argument(text(), "target"),
    },
    CommandName.STUDY_STEP: {
        "trainee": Argument(text()),
        "kind": Argument(one_of(*(kind.value for kind in StepKind), ALL_DONE, FREE, REPEAT)),
        "number": Argument(whole_number(1, 100_000), 0),
        "count": Argument(whole_number(1, 100_000), 0),
        "task": Argument(text(), ""),
        "mode": Argument(one_of(*(mode.value for mode in Mode)), ""),
        "questionnaire": Argument(text(), ""),
        "minutes": Argument(number(0, 43_200, "min"), 0.0),
        "over": Argument(number(0, 43_200, "min"), 0.0),
        "guidance": Argument(one_of(*(choice.value for choice in Guidance)), ""),
        "ghost": Argument(one_of(*(rule.value for rule in GhostRule)), ""),
        "procedure": Argument(text(40, 0), ""),
        "tutorial": Argument(one_of(*(rule.value for rule in TutorialRule)), ""),
        "method": Argument(text(40, 0), ""),
        "skin": Argument(skin_amounts, {}),
    },
    CommandName.CURRICULUM: {
        "trainee": Argument(text()),
        "title": Argument(text(80, 0), ""),
        "next": Argument(text(40, 0), ""),
        "assignments": Argument(told_assignments, ()),
    },
    CommandName.GET_TRIAL: {"trialId": Argument(trial_id)},
    CommandName.ACKNOWLEDGE_TRIAL: {"trialId": Argument(trial_id)},
}
"""Every command a client may send; `MoveTipTo`'s direction is that of the tool, from A7 to tip."""


def check_arguments(command: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the checked arguments of a command with defaults.

    Raises:
        InputError: the command or an argument is unknown, missing or out of range.
    """
    if command not in COMMAND_ARGUMENTS:
        known = ", ".join(COMMAND_ARGUMENTS)
        raise InputError(f"The command {_quoted(command)} is unknown; known are {known}.")
    expected = COMMAND_ARGUMENTS[command]
    for name in arguments:
        if name not in expected:
            takes = ", ".join(expected) or "none"
            raise InputError(f"{command} has no argument {_quoted(name)}; it takes {takes}.")
    fields = {}
    for name, argument in expected.items():
        if name not in arguments and argument.is_required:
            raise InputError(f"{command} needs the argument {name}.")
        fields[name] = argument.checked(arguments, name, f"{command}: the argument {name}")
    return fields


def _quoted(word: object) -> str:
    return json.dumps(str(word)[:40])


def decode_json_object(body: str) -> dict[str, Any]:
    """Return the JSON object in a command's body; an empty body is an empty object.

    Raises:
        InputError: as `rastrainer.finite_json.decode_message_object`.
    """
    return decode_message_object(body or "{}", "The command's body")


def decode_told_object(body: str) -> dict[str, Any]:
    """Return the JSON object in an answer of the simulator, such as a trial's record.

    Raises:
        InputError: as `decode_json_object`; it may hold more values.
    """
    return decode_message_object(body or "{}", "The simulator's message", MAX_RECORD_VALUES)
