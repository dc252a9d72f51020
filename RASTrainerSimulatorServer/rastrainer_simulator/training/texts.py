"""Every sentence that the simulation says to the trainee and to clients, in one place.

A translation is a table with the same keys; what it lacks is said in English.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

ENGLISH: Mapping[str, str] = MappingProxyType(
    {
        # What the trainee reads at the top of the picture.
        "idle": "Choose a task to start.",
        "start": "{trainee}, touch point {point}.",
        "touched": "{trainee}, point {label} is recorded. Now touch point {point}.",
        "undone": "{trainee}, point {label} is taken back. Touch it again.",
        "complete": "{trainee}, all {count} points are touched. Register them now.",
        "paused": "{trainee}, the trial is paused. Resume when you are ready.",
        "resumed": "{trainee}, go on with point {point}.",
        "registered": "{trainee}, your points are on their way to be registered and scored.",
        "scored": "{trainee}, your score is {score:.0f} of 100: {fre:.2f} mm registration error, "
        "{tre:.2f} mm true error at the target.",
        "aborted": "{trainee}, the trial was aborted. Choose a task to start again.",
        # Touches that do not count.
        "too far": "Too far from point {point}: {distance:.1f} mm; a touch counts within "
        "{radius:g} mm.",
        "wrong point": "Wrong point: that is point {label}, {nearest:.1f} mm away; point {point} "
        "is next.",
        # Commands in the wrong phase.
        "no trial": "No trial is running: begin one with StartTask.",
        "trial is open": "{trainee} is still at {task}: Register or Abort it before StartTask.",
        "not all touched": "{kept} of {count} points are touched: Register comes after the last; "
        "point {point} is next.",
        "not paused": "The trial is not paused: Capture point {point}, or Pause it first.",
        "is paused": "The trial is paused: Resume it first.",
        "already paused": "The trial is paused already: Resume or Abort it.",
        "all touched": "All {count} points are touched: Register them, or Undo the last one.",
        "is registered": "The trial is registered and kept: StartTask begins the next.",
        "nothing to undo": "No point is touched yet: Capture point {point} first.",
        "not registered": "The trial is not registered yet: Capture its {count} points and "
        "Register them first.",
        "no such trial": "There is no trial {trial_id} here: GetTrial and TrialScored take the ID "
        "that StartTask answered.",
        "not a simulation command": "{command} is not a command of the simulation.",
        # When the record cannot be written.
        "not recorded": "The trial cannot be recorded ({reason}). What was not recorded does not "
        "count; make room or choose another folder, then go on.",
    }
)


class Texts:
    """Says the sentences, in the language of its table."""

    def __init__(self, table: Mapping[str, str] = ENGLISH) -> None:
        self._table = {**ENGLISH, **table}

    def say(self, key: str, **values: object) -> str:
        """Return the sentence with its values filled in."""
        return self._table[key].format(**values)
