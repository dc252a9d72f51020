"""What is heard and felt of each thing that happens."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from rastrainer.protocol import Phase, Proximity
from rastrainer_simulator.state import Event, EventKind


class Happening(str, Enum):
    """Everything that is told to the trainee's senses; the kinds of the views' events."""

    TOUCH = "touch"
    UNDO = "undo"
    ERROR = "error"
    PROXIMITY_IN = "proximity-in"
    PROXIMITY_OUT = "proximity-out"
    CONTACT = "contact"
    CONTACT_OUT = "contact-out"
    FINISH = "finish"
    FOCUS = "focus"
    ACCEPT = "accept"
    TEST = "test"


@dataclass(frozen=True)
class Sensation:
    """How something feels.

    Attributes:
        sound: name of the sound, "" for none.
        rumble: strength of the vibration, 0 to 1.
        seconds: how long it vibrates.
    """

    sound: str
    rumble: float = 0.0
    seconds: float = 0.0


SENSATIONS: Mapping[Happening, Sensation] = {
    Happening.TOUCH: Sensation("touch", 0.5, 0.12),
    Happening.UNDO: Sensation("undo", 0.3, 0.12),
    Happening.ERROR: Sensation("error", 0.7, 0.3),
    Happening.PROXIMITY_IN: Sensation("proximity", 0.35, 0.2),
    Happening.PROXIMITY_OUT: Sensation("", 0.15, 0.08),
    Happening.CONTACT: Sensation("contact", 1.0, 0.4),
    Happening.CONTACT_OUT: Sensation("", 0.2, 0.08),
    Happening.FINISH: Sensation("finish", 0.6, 0.5),
    Happening.FOCUS: Sensation("focus"),
    Happening.ACCEPT: Sensation("accept"),
    Happening.TEST: Sensation("", 0.6, 0.2),
}


def happening(event: Event, not_recorded: bool = False) -> Happening | None:
    """Return what an event of the simulation means to the senses, None where it is silent.

    `not_recorded` tells that a change of the phase took back what the disk had refused.
    """
    if event.kind is EventKind.TOUCH:
        return Happening.TOUCH
    if event.kind is EventKind.UNDO:
        return Happening.UNDO
    if event.kind is EventKind.REJECTED:
        return Happening.ERROR
    if event.kind is EventKind.PROXIMITY:
        return _of_proximity(Proximity(event.data["from"]), Proximity(event.data["to"]))
    if event.kind is EventKind.PHASE and not_recorded:
        return Happening.ERROR
    if event.kind is EventKind.PHASE and event.data["phase"] == Phase.REGISTERED:
        return Happening.FINISH
    return None


def _of_proximity(before: Proximity, after: Proximity) -> Happening:
    if after is Proximity.CONTACT:
        return Happening.CONTACT
    if after is Proximity.FREE:
        return Happening.PROXIMITY_OUT
    return Happening.CONTACT_OUT if before is Proximity.CONTACT else Happening.PROXIMITY_IN
