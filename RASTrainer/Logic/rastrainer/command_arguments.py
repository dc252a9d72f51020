"""The arguments of every command that a client may send, and the JSON in which they come."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any, cast

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    MAX_RECORD_VALUES,
    Argument,
    decode_message_object,
    number,
    numbers,
    one_of,
    plain_object,
    pseudonym,
    text,
    trial_id,
    whole_number,
    yes_or_no,
)
from rastrainer.json_records import RecordField, record_fields
from rastrainer.protocol import (
    COMMANDED_ABORTS,
    FEED_LIMIT_MM_S,
    MAX_JOURNAL_BYTES,
    SPEED_LIMIT_MM_S,
    STAND_OFF_LIMIT_MM,
    WORLD_LIMIT_MM,
    AbortReason,
    CommandName,
    Mode,
    Rate,
)
from rastrainer.study_messages import CurriculumMessage, StudyStep, skin_amounts


def deflection(value: float) -> float:
    """Return how far something is pushed, limited to −1…1; 0 for what is no finite number.

    `max(-1, min(1, value))` would make full speed of a value that is not a number.
    """
    return max(-1.0, min(1.0, value)) if math.isfinite(value) else 0.0


def _arguments_of(command: str, kind: type[Any]) -> dict[str, Argument]:
    """Return the arguments of a command that are one record."""

    def argument(each: RecordField) -> Argument:
        place = f"{command}: the argument {each.key}"
        default = ... if each.default is None else each.default()
        return Argument(lambda value: each.read(value, place, True), default)

    return {each.key: argument(each) for each in record_fields(cast("Any", kind))}


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
    CommandName.STUDY_STEP: _arguments_of(CommandName.STUDY_STEP, StudyStep),
    CommandName.CURRICULUM: _arguments_of(CommandName.CURRICULUM, CurriculumMessage),
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
