"""One trainee's tutorial: which step is next, how much of it is done, and what came of it."""

from __future__ import annotations

import uuid
from collections.abc import Mapping

from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.flow.tutorial.steps import (
    MEASURES,
    WITH_POINTS,
    StepMeasure,
    TutorialObservation,
    TutorialStep,
    steps_for,
)
from rastrainer_simulator.flow.tutorial.touch_practice import TouchPractice
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.record.beside_the_trial import GUIDED_TOUCHES, TutorialOutcome
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.training.training import TrainingReply
from rastrainer_simulator.vectors import Vector, vector

PRAISE_S = 0.8
"""How long a step that is done is praised before the next one begins."""
_MAY_TOUCH = (TutorialStep.LOWER, TutorialStep.TOUCH, TutorialStep.GUIDED)
_MAY_UNDO = (TutorialStep.UNDO, TutorialStep.GUIDED)


class Tutorial:
    """Leads through the steps, each of which is done when what it asks for has really happened.

    Attributes:
        trainee: pseudonym.
        mode: display mode.
        setup: the simulation's, at the beginning.
        steps: in order, for the device in use.
        praised: the step that was just done, while it is praised; else None.
    """

    def __init__(
        self,
        setup: SimulationSetup,
        state: SimulationState,
        arguments: dict[str, str],
        texts: Texts,
    ) -> None:
        """Begin; `arguments` are checked ones of StartTask."""
        self.trainee, self.mode = arguments["trainee"], arguments["mode"]
        self.setup = setup
        trial = {**arguments, "trialId": str(uuid.uuid4())}
        self._first = TouchPractice(setup, state, trial, slice(1), texts)
        guided, rest = slice(1, 1 + GUIDED_TOUCHES), self._first.goal
        self._guided = TouchPractice(setup, state, trial, guided, texts, rest)
        self._guided.show_points()
        self.praised: TutorialStep | None = None
        self._praise_s = 0.0
        self.steps = steps_for(SourceKind.KEYBOARD, self.mode)
        self._done: list[TutorialStep] = []
        self._measure: StepMeasure | None = None
        self._before: TutorialObservation | None = None
        self._seconds: dict[str, float] = {}
        self._first_error_mm = 0.0

    @property
    def practice(self) -> TouchPractice:
        """The touches: one to begin with, then the guided ones at other points."""
        return self._guided if self.step in (TutorialStep.GUIDED, None) else self._first

    @property
    def fiducials(self) -> Mapping[str, Vector]:
        """The points that are touched: label → World, mm."""
        practices = (self._first.truth, self._guided.truth)
        return {
            label: vector(truth.in_world(point).tolist())
            for truth in practices
            for label, point in truth.fiducials.items()
        }

    @property
    def step(self) -> TutorialStep | None:
        """The step that is next; None once all are done."""
        return next((step for step in self.steps if step not in self._done), None)

    @property
    def is_done(self) -> bool:
        """Whether all steps are done, and the last one is praised."""
        return self.step is None and self.praised is None

    @property
    def place(self) -> tuple[int, int]:
        """The number of the step, from 1, and how many there are."""
        done = sum(step in self._done for step in self.steps)
        return min(done + 1, len(self.steps)), len(self.steps)

    @property
    def amount(self) -> tuple[float, float]:
        """How much of the step is done, and how much there is to do."""
        if self._measure is None:
            return 0.0, 1.0
        return min(self._measure.done, self._measure.goal), self._measure.goal

    @property
    def has_learned_view(self) -> bool:
        """Whether the view may go to the next point by itself."""
        return self.step in (None, TutorialStep.GUIDED)

    @property
    def may_touch(self) -> bool:
        """Whether a touch is part of the step."""
        return self.step in _MAY_TOUCH

    @property
    def may_undo(self) -> bool:
        """Whether an undo is part of the step."""
        return self.step in _MAY_UNDO

    def use(self, device: SourceKind) -> None:
        """Teach the controls of a device from now on."""
        self.steps = steps_for(device, self.mode)

    def advance(self, dt: float, now: TutorialObservation) -> TutorialStep | None:
        """Advance by `dt` seconds; return the step that has just been done."""
        before, self._before = self._before or now, now
        if self.praised is not None:
            self._praise_s -= dt
            if self._praise_s > 0.0:
                return None
            self.praised = None
        step = self.step
        if step is None:
            return None
        if step in WITH_POINTS and not self._first.has_points:
            self._first.show_points()
        self._measure = self._measure or MEASURES[step]()
        self._seconds[step.value] = self._seconds.get(step.value, 0.0) + dt
        self._measure.take(before, now)
        if not self._measure.is_complete:
            return None
        self._done.append(step)
        self._measure = None
        self.praised, self._praise_s = step, PRAISE_S
        return step

    def touch(self, state: SimulationState) -> TrainingReply:
        """Record a touch, or refuse it."""
        reply = self.practice.touch(state)
        if reply.ok and TutorialStep.TOUCH not in self._done:
            (self._first_error_mm,) = self._first.errors_mm()
        return reply

    def outcome(self, device: SourceKind) -> TutorialOutcome:
        """Return what came of it, once all steps are done."""
        return TutorialOutcome(
            trainee=self.trainee,
            device=device.value,
            mode=self.mode,
            seconds=sum(self._seconds.values()),
            first_error_mm=self._first_error_mm,
            errors_mm=self._guided.errors_mm(),
            step_seconds=dict(self._seconds),
        )
