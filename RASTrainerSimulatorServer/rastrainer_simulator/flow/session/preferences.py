"""The preferences chosen at the simulator, and which of them an instructor's PIN locks."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from enum import Enum
from pathlib import Path
from typing import Annotated, Any, get_type_hints

from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import text
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import GhostRule, Guidance, TouchRule, TutorialRule
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.ops.instructor_pin import InstructorPin, PinAnswer
from rastrainer_simulator.teleoperation.steering import AxesChoice, ToolDirection
from rastrainer_simulator.texts.texts import LANGUAGES

PREFERENCES_FILE = "preferences.json"
MAX_BYTES = 2**14


class _OneOf:
    """Accepts one of some options; 1 is not true."""

    def __init__(self, *options: Any) -> None:
        self.options = options

    def __call__(self, value: Any) -> Any:
        if not any(type(value) is type(each) and value == each for each in self.options):
            raise ValueError("one of " + ", ".join(map(json.dumps, self.options)))
        return value


def _any_of(kind: type[Enum]) -> _OneOf:
    return _OneOf(*(each.value for each in kind))


@dataclasses.dataclass(frozen=True)
class Preferences:
    """The choices of people at the simulator; all but the expert have `OPTIONS`.

    Attributes:
        volume: of the sounds, percent.
        speech: whether page and headset read instructions, warnings and pages aloud.
        order: "fixed" where a task waits for the previous task, "any" by the instructor's leave.
        coarse: fastest travel of the tip, mm/s.
        fine: the same while the trigger for fine speed is held, mm/s.
        view: when the view goes to each next point automatically: "practice" is outside of a study.
        ghost: the earlier trial that is shown next to the arm, outside of studies.
        expert: ID of the trainee whose best acceptable trials are the ghost "expert"; any text.
        tutorial: whether it comes before the trial run, unless a study says otherwise.
    """

    language: Annotated[str, _OneOf(*LANGUAGES)] = "en"
    volume: Annotated[int, _OneOf(*range(0, 101, 10))] = 70
    muted: Annotated[bool, _OneOf(False, True)] = False
    speech: Annotated[bool, _OneOf(False, True)] = False
    order: Annotated[str, _OneOf("fixed", "any")] = "fixed"
    coarse: Annotated[int, _OneOf(50, 100, 150, 200, 300)] = 150
    fine: Annotated[int, _OneOf(5, 10, 20, 40)] = 20
    axes: Annotated[str, _any_of(AxesChoice)] = AxesChoice.CAMERA.value
    direction: Annotated[str, _any_of(ToolDirection)] = ToolDirection.CLEAR.value
    touch: Annotated[str, _any_of(TouchRule)] = TouchRule.ON_SKIN.value
    self_alignment: Annotated[bool, _OneOf(True, False)] = True
    view: Annotated[str, _OneOf("practice", "always", "never")] = "practice"
    guidance: Annotated[str, _any_of(Guidance)] = Guidance.FADING.value
    ghost: Annotated[str, _any_of(GhostRule)] = GhostRule.OFF.value
    expert: Annotated[str, text(64, 0)] = ""
    tutorial: Annotated[str, _any_of(TutorialRule)] = TutorialRule.REQUIRED.value

    def applied_to(self, settings: SimulationSettings) -> SimulationSettings:
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
    name: mark.options
    for name, hint in get_type_hints(Preferences, include_extras=True).items()
    for mark in hint.__metadata__
    if isinstance(mark, _OneOf)
}
OF_THE_SIMULATION = ("coarse", "fine", "axes", "direction", "touch", "self_alignment")
OF_INSTRUCTORS = ("order", "tutorial")
"""Preferences that are changed in the file, or with the instructor's PIN where there is one.

Trainees do not decide which tasks they skip.
"""
OF_TRAINEES = ("language", "volume", "muted", "speech")
"""Preferences that no PIN locks: trainees have to understand and hear."""
OF_A_TRIAL = (*OF_THE_SIMULATION, "guidance", "ghost")
"""Preferences that a running trial must not change: they are in its record."""


def read_preferences(path: Path) -> Preferences:
    values = read_json(path, MAX_BYTES)
    return record_from_json(Preferences, values, str(path), only_known=True)


def write_preferences(path: Path, preferences: Preferences) -> None:
    write_private_json(path, record_to_json(preferences, with_defaults=True))


@dataclasses.dataclass
class InstructorLock:
    """The lock of an instructor's PIN on settings, order, and passing on the control.

    If a PIN is set, it is locked until somebody enters the PIN, and again when the trainee changes
    or a trial or tutorial begins: the instructor may have left by then. The PIN may be set and
    removed at any time; None locks nothing.
    """

    _pin: InstructorPin | None
    is_open: bool = False
    _seen: tuple[str, str, bool] = "", "", False

    @property
    def has_pin(self) -> bool:
        return self._pin is not None and self._pin.is_set

    @property
    def is_locked(self) -> bool:
        return self.has_pin and not self.is_open

    def check(self, pin: str) -> Future[PinAnswer]:
        """Check a PIN outside of this thread: that takes about 50 ms."""
        assert self._pin is not None, "only a lock with a PIN asks for one"
        worker = ThreadPoolExecutor(1, "instructor-pin")
        answer = worker.submit(self._pin.guess, pin)
        worker.shutdown(wait=False)
        return answer

    def lock(self) -> None:
        self.is_open = False

    def follow(self, trainee: str, trial_id: str, has_tutorial: bool) -> None:
        """Note the trainee, the trial, "" for none, and whether a tutorial is open."""
        before, self._seen = self._seen, (trainee, trial_id, has_tutorial)
        is_other_trial = trial_id not in ("", before[1])
        if trainee != before[0] or is_other_trial or (has_tutorial and not before[2]):
            self.lock()
