"""The preferences chosen at the simulator, and which of them an instructor's PIN locks."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import accepted, text
from rastrainer.protocol import TRIAL_RUN, GhostRule, Guidance, TouchRule, TutorialRule
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.ops.instructor_pin import InstructorPin, PinAnswer
from rastrainer_simulator.teleoperation.steering import AxesChoice, ToolDirection
from rastrainer_simulator.texts.texts import LANGUAGES

PREFERENCES_FILE = "preferences.json"
MAX_BYTES = 2**14
_ARROW_TASKS = 2
"""How many tasks after the trial run have an arrow, where guidance fades."""


@dataclasses.dataclass(frozen=True)
class Preferences:
    """Each but the expert is one of its `OPTIONS`.

    Attributes:
        language: of everything the trainee reads.
        volume: of the sounds, percent.
        muted: whether there are none.
        speech: whether page and headset read instructions, warnings and pages aloud.
        order: "fixed" where a task waits for the one before it, "any" by the instructor's leave.
        coarse: fastest travel of the tip, mm/s.
        fine: the same while the trigger for fine speed is held, mm/s.
        axes: whose right, forward and up the sticks follow.
        direction: who decides the tool's direction.
        touch: whether a touch has to be on the skin.
        self_alignment: whether the robot may align a procedure's guide by itself.
        view: when the view goes to each next point automatically: "practice" is outside of a study.
        guidance: how the trainee is guided to the next point, unless a study says otherwise.
        ghost: which earlier trial is shown beside the arm, outside of studies.
        expert: ID of the trainee whose best acceptable trials are the ghost "expert"; any text.
        tutorial: whether it comes before the trial run, unless a study says otherwise.
    """

    language: str = "en"
    volume: int = 70
    muted: bool = False
    speech: bool = False
    order: str = "fixed"
    coarse: int = 150
    fine: int = 20
    axes: str = AxesChoice.CAMERA.value
    direction: str = ToolDirection.CLEAR.value
    touch: str = TouchRule.ON_SKIN.value
    self_alignment: bool = True
    view: str = "practice"
    guidance: str = Guidance.FADING.value
    ghost: str = GhostRule.OFF.value
    expert: str = ""
    tutorial: str = TutorialRule.REQUIRED.value

    def stepped(self, name: str, direction: int) -> Preferences:
        """Return the preferences with one of them moved to its next or previous option."""
        options = OPTIONS[name]
        place = (options.index(getattr(self, name)) + direction) % len(options)
        return dataclasses.replace(self, **{name: options[place]})

    def applied_to(self, settings: SimulationSettings) -> SimulationSettings:
        """Return the simulation's settings as preferred."""
        teleoperation = settings.teleoperation
        return dataclasses.replace(
            settings,
            axes=AxesChoice(self.axes),
            training=dataclasses.replace(settings.training, touch_rule=TouchRule(self.touch)),
            procedure=dataclasses.replace(settings.procedure, self_alignment=self.self_alignment),
            teleoperation=dataclasses.replace(
                teleoperation,
                coarse_speed=self.coarse / MM_PER_M,
                fine_speed=self.fine / MM_PER_M,
                steering=dataclasses.replace(
                    teleoperation.steering, choice=ToolDirection(self.direction)
                ),
            ),
        )


OPTIONS: Mapping[str, tuple[Any, ...]] = {
    "language": tuple(LANGUAGES),
    "volume": tuple(range(0, 101, 10)),
    "muted": (False, True),
    "speech": (False, True),
    "order": ("fixed", "any"),
    "coarse": (50, 100, 150, 200, 300),
    "fine": (5, 10, 20, 40),
    "axes": tuple(choice.value for choice in AxesChoice),
    "direction": tuple(choice.value for choice in ToolDirection),
    "touch": tuple(rule.value for rule in TouchRule),
    "self_alignment": (True, False),
    "view": ("practice", "always", "never"),
    "guidance": tuple(choice.value for choice in Guidance),
    "ghost": tuple(rule.value for rule in GhostRule),
    "tutorial": tuple(rule.value for rule in TutorialRule),
}

EXPERT = "expert"
OF_THE_SIMULATION = ("coarse", "fine", "axes", "direction", "touch", "self_alignment")
OF_INSTRUCTORS = ("order", "tutorial")
"""Preferences that are changed in the file, or with the instructor's PIN where there is one.

Trainees do not decide what they may leave out.
"""
OF_TRAINEES = ("language", "volume", "muted", "speech")
"""Preferences that no PIN locks: trainees have to understand and hear."""
OF_A_TRIAL = (*OF_THE_SIMULATION, "guidance", "ghost")
"""Preferences that a running trial must not change: they are in its record."""


def read_preferences(path: Path) -> Preferences:
    """Return the preferences of a file; missing ones have their defaults."""
    values = read_json(path, MAX_BYTES)
    if not isinstance(values, dict) or not values.keys() <= {*OPTIONS, EXPERT}:
        known = ", ".join((*OPTIONS, EXPERT))
        raise InputError(f"{path} must be a JSON object with any of {known}.")
    expert = accepted(text(64, 0), values.pop(EXPERT, ""), f"{path}: {EXPERT}")
    for name, value in values.items():
        options = OPTIONS[name]
        if not any(type(value) is type(option) and value == option for option in options):
            listed = ", ".join(json.dumps(option) for option in options)
            raise InputError(f"{path}: {name} must be one of {listed}.")
    return Preferences(**values, expert=expert)


def write_preferences(path: Path, preferences: Preferences) -> None:
    """Save the preferences."""
    write_private_json(path, dataclasses.asdict(preferences))


def faded_guidance(choice: str, task: str, order: Sequence[str]) -> Guidance:
    """Return the guidance of a task: `choice` is a `Guidance`, `order` names all tasks."""
    if choice != Guidance.FADING:
        return Guidance(choice)
    if task == TRIAL_RUN:
        return Guidance.WORDS
    tasks = [name for name in order if name != TRIAL_RUN]
    return Guidance.ARROW if task in tasks[:_ARROW_TASKS] else Guidance.NONE


class InstructorLock:
    """What a PIN locks: the settings, the order, and passing on the control.

    It is locked wherever a PIN is set, until somebody enters it, and again when the trainee
    changes, and when a trial or a tutorial begins: whoever trains then is not whom the instructor
    stood beside.
    """

    def __init__(self, pin: InstructorPin | None) -> None:
        """Lock by a PIN, which may be set and removed at any time; None locks nothing."""
        self._pin = pin
        self._is_open = False
        self._asked: Future[PinAnswer] | None = None
        self._seen = ("", "", False)

    @property
    def has_pin(self) -> bool:
        return self._pin is not None and self._pin.is_set

    @property
    def is_locked(self) -> bool:
        """Whether the PIN has to be entered first."""
        return self.has_pin and not self._is_open

    def guess(self, pin: str) -> None:
        """Have a PIN checked, outside of this thread: that takes about 50 ms."""
        if self._pin is not None and self._asked is None:
            worker = ThreadPoolExecutor(1, "instructor-pin")
            self._asked = worker.submit(self._pin.guess, pin)
            worker.shutdown(wait=False)

    def take_answer(self) -> PinAnswer | None:
        """Return the outcome of the guess, once, and unlock if it was right; None before."""
        if self._asked is None or not self._asked.done():
            return None
        asked, self._asked = self._asked, None
        answer = asked.result()
        self._is_open = answer.is_right
        return answer

    def forget_guess(self) -> None:
        """Unlock nothing by a PIN that is still being checked."""
        self._asked = None

    def lock(self) -> None:
        self._is_open = False

    def follow(self, trainee: str, trial_id: str, has_tutorial: bool) -> None:
        """Note the trainee, the trial, "" for none, and whether a tutorial is open."""
        before, self._seen = self._seen, (trainee, trial_id, has_tutorial)
        is_other_trial = trial_id not in ("", before[1])
        if trainee != before[0] or is_other_trial or (has_tutorial and not before[2]):
            self.lock()
