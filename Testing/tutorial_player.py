"""A virtual trainee at the tutorial: does what each step asks for, by any input device."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, Protocol

from rastrainer_simulator.flow.session.tutorial import TutorialStep, steps_for
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.presentation.screen import Screen

_PLACE = re.compile(r"(?:Step|Schritt) (\d+) (?:of|von) (\d+)")
PUSH = 0.45
"""A gentle push, which may be released late."""
_WAYS = {
    TutorialStep.RIGHT: (PUSH, 0.0, 0.0),
    TutorialStep.LEFT: (-PUSH, 0.0, 0.0),
    TutorialStep.FORWARD: (0.0, PUSH, 0.0),
    TutorialStep.BACK: (0.0, -PUSH, 0.0),
    TutorialStep.UP: (0.0, 0.0, PUSH),
    TutorialStep.DOWN: (0.0, 0.0, -PUSH),
    TutorialStep.SLOW: (PUSH, 0.0, 0.0),
}


class Learner(Protocol):
    """A trainee for the player, in the flow's process or at a view."""

    hands: Any

    @property
    def screen(self) -> Screen:
        """The present screen."""

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Let time pass until a condition is true."""

    def turn_view(self) -> None:
        """Turn the view a little more."""

    def lower(self) -> None:
        """Bring the tip onto the next point."""

    def touch_next(self) -> None:
        """Touch the next point."""

    def resume(self) -> None:
        """Continue from the menu that is open."""


class TutorialPlayer:
    """Plays the tutorial from its first step to the page after it.

    Attributes:
        read: every instruction, with the step it was read in.
    """

    def __init__(self, learner: Learner, device: SourceKind, mode: str = "desktop"):
        self._learner = learner
        self._steps = steps_for(device, mode)
        self.read: list[tuple[TutorialStep, str]] = []

    @property
    def step(self) -> TutorialStep | None:
        """The step that the screen names; None without one."""
        found = [place for fact in self._learner.screen.status if (place := _PLACE.match(fact))]
        if not found:
            return None
        number, count = map(int, found[0].groups())
        # Steps of another device are shown until the first input.
        if count != len(self._steps):
            return None
        return self._steps[number - 1]

    def play(self, look: Callable[[TutorialStep], None] = lambda _step: None) -> None:
        """Do every step; `look` is called in each before anything is done."""
        learner = self._learner
        learner.until(lambda: self.step is not None, "the tutorial")
        for step in self._steps:
            learner.until(lambda s=step: self._is_asked(s), f"the step {step.value}")
            self.read.append((step, learner.screen.instruction.text))
            look(step)
            self._do(step)
        learner.until(lambda: learner.screen.menu is not None, "the end of the tutorial")

    def _is_asked(self, step: TutorialStep) -> bool:
        is_praised = self._learner.screen.instruction.tone == "good"
        return self.step is step and not (is_praised and step not in (TutorialStep.TOUCH,))

    def _do(self, step: TutorialStep) -> None:
        learner = self._learner
        if step in _WAYS:
            learner.hands.push(*_WAYS[step], step is TutorialStep.SLOW)
            learner.until(lambda: self.step is not step, step.value)
            learner.hands.push(0.0, 0.0, 0.0, False)
        elif step in (TutorialStep.TURN_VIEW, TutorialStep.LOOK_AROUND):
            learner.turn_view()
        elif step is TutorialStep.LOWER:
            learner.lower()
        elif step is TutorialStep.GUIDED:
            for _ in range(3):
                learner.touch_next()
        elif step is TutorialStep.PAUSE:
            learner.hands.tap("menu")
            learner.until(lambda: learner.screen.menu is not None, "the menu")
            learner.resume()
        else:
            learner.hands.tap(step.value.replace(" ", "_"))
