"""The arguments of every command that a client may send, and the JSON in which they come."""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    MAX_RECORD_VALUES,
    Argument,
    checked_keys,
    decode_message_object,
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
from rastrainer.protocol import (
    ALL_DONE,
    COMMANDED_ABORTS,
    FEED_LIMIT_MM_S,
    FREE,
    MAX_ASSIGNMENTS,
    MAX_GATES,
    MAX_JOURNAL_BYTES,
    REPEAT,
    SKIN_KEYS,
    SKIN_LIMIT_MM,
    SPEED_LIMIT_MM_S,
    STAND_OFF_LIMIT_MM,
    WORLD_LIMIT_MM,
    AbortReason,
    AssignmentState,
    CommandName,
    GhostRule,
    GoalKind,
    Guidance,
    Mode,
    Rate,
    StepKind,
    TutorialRule,
)


def deflection(value: float) -> float:
    """Return how far something is pushed, limited to −1…1; 0 for what is no finite number.

    `max(-1, min(1, value))` would make full speed of a value that is not a number.
    """
    return max(-1.0, min(1.0, value)) if math.isfinite(value) else 0.0


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


def checked_assignments(value: Any) -> tuple[dict[str, Any], ...]:
    """Accept a list of a trainee's progress in each assignment; missing values get defaults.

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
        "assignments": Argument(checked_assignments, ()),
    },
    CommandName.GET_TRIAL: {"trialId": Argument(trial_id)},
    CommandName.GET_JOURNAL: {
        "trialId": Argument(trial_id),
        "start": Argument(whole_number(0, MAX_JOURNAL_BYTES), 0),
    },
    CommandName.ACKNOWLEDGE_TRIAL: {"trialId": Argument(trial_id)},
}
"""Every command a client may send; `MoveTipTo`'s direction is that of the tool, from A7 to tip."""


def check_arguments(command: str, arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Return the checked arguments of a command with defaults."""
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
    """Return the JSON object in a command's body; an empty body is an empty object."""
    return decode_message_object(body or "{}", "The command's body")


def decode_answer_object(body: str) -> dict[str, Any]:
    """Return the JSON object in an answer of the simulator, such as a trial's record."""
    return decode_message_object(body or "{}", "The simulator's message", MAX_RECORD_VALUES)
