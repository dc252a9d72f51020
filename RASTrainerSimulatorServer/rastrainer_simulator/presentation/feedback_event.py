"""Sound and vibration of each event."""

from __future__ import annotations

from enum import Enum

from rastrainer.journal.entries import (
    AcceptedCheckpoint,
    AcceptedTouch,
    FeedChange,
    PhaseChange,
    ProximityChange,
    Rejected,
    Undo,
)
from rastrainer.protocol import PROCEDURE_PHASES, Phase, Proximity
from rastrainer_simulator.state import TOUCH_ERRORS, Event, TouchStage
from rastrainer_simulator.training.feed import FeedLayer


class FeedbackEvent(str, Enum):
    """Everything that has a sound or a vibration: the kinds of the views' events.

    Each has a sound, "" for none, and vibrates so strongly (0 to 1) and so long.
    """

    sound: str
    rumble: float
    seconds: float

    TOUCH = "touch", "touch", 0.5, 0.12
    UNDO = "undo", "undo", 0.3, 0.12
    ERROR = "error", "error", 0.7, 0.3
    PROXIMITY_IN = "proximity-in", "proximity", 0.35, 0.2
    PROXIMITY_OUT = "proximity-out", "", 0.15, 0.08
    CONTACT = "contact", "contact", 1.0, 0.4
    ON_SKIN = "on-skin", "on-skin", 0.25, 0.1
    CONTACT_OUT = "contact-out", "", 0.2, 0.08
    FINISH = "finish", "finish", 0.6, 0.5
    FOCUS = "focus", "focus"
    ACCEPT = "accept", "accept"
    TEST = "test", "", 0.6, 0.2
    STEP = "step", "accept", 0.3, 0.12
    CHECKPOINT = "checkpoint", "touch", 0.5, 0.12
    BONE = "bone", "proximity", 0.5, 0.3
    THROUGH = "through", "contact", 1.0, 0.4
    BLOCKED = "blocked", "error", 0.7, 0.3

    def __new__(
        cls, kind: str, sound: str, rumble: float = 0.0, seconds: float = 0.0
    ) -> FeedbackEvent:
        event = str.__new__(cls, kind)
        event._value_, event.sound = kind, sound
        event.rumble, event.seconds = rumble, seconds
        return event


_OF_A_KIND = {
    AcceptedTouch: FeedbackEvent.TOUCH,
    Undo: FeedbackEvent.UNDO,
    Rejected: FeedbackEvent.ERROR,
    AcceptedCheckpoint: FeedbackEvent.CHECKPOINT,
}
_OF_A_LAYER = {
    FeedLayer.BONE.value: FeedbackEvent.BONE,
    FeedLayer.THROUGH.value: FeedbackEvent.THROUGH,
    FeedLayer.BLOCKED.value: FeedbackEvent.BLOCKED,
}
"""Layers that a hand feels through a drill or an instrument; skin and scalp are not felt."""


def feedback_event(
    event: Event, touch: TouchStage, not_recorded: bool = False
) -> FeedbackEvent | None:
    """Return the feedback to an event of the simulation; None without any.

    `touch` is how the touch is going when it happens: a contact where a touch counts is no alarm.
    `not_recorded` says that a change of the phase undid what the disk had refused.
    """
    entry = event.entry
    if isinstance(entry, FeedChange):
        return _OF_A_LAYER.get(entry.layer)
    if isinstance(entry, ProximityChange):
        if entry.to is Proximity.CONTACT:
            is_on_point = touch in (TouchStage.ON_SKIN, TouchStage.PRESSED)
            return FeedbackEvent.ON_SKIN if is_on_point else FeedbackEvent.CONTACT
        left = entry.from_ is Proximity.CONTACT
        nearer = FeedbackEvent.CONTACT_OUT if left else FeedbackEvent.PROXIMITY_IN
        return FeedbackEvent.PROXIMITY_OUT if entry.to is Proximity.FREE else nearer
    if not isinstance(entry, PhaseChange):
        return _OF_A_KIND.get(type(entry))
    if not_recorded:
        return FeedbackEvent.ERROR
    if entry.phase is Phase.REGISTERED:
        return FeedbackEvent.FINISH
    return FeedbackEvent.STEP if entry.phase in PROCEDURE_PHASES else None


def touch_feedback(before: TouchStage, after: TouchStage) -> FeedbackEvent | None:
    """Return the feedback to a touch that becomes right or wrong while the tool is in contact."""
    if after is TouchStage.ON_SKIN and before in TOUCH_ERRORS:
        return FeedbackEvent.ON_SKIN
    is_worse = after in TOUCH_ERRORS and before not in TOUCH_ERRORS
    return FeedbackEvent.CONTACT if is_worse else None
