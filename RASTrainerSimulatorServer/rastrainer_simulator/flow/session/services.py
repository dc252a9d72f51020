"""Services of the process for the flow, and the reload of the simulation between two trials."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path

from rastrainer.scenario.library import ListedScenario
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.flow.session.assigned_training import AssignedTraining
from rastrainer_simulator.loop.control_loop import BEING_SET_UP, TRIAL_IS_OPEN, ControlLoop
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.state import Answer

SET_UP_AFTER_S = 1.0
"""A simulation takes a second to make: who steps through the options shall not wait for each."""


@dataclass(frozen=True)
class FlowServices:
    """Services of the process for the flow.

    Attributes:
        records: folder of the trials' journals.
        use_settings, use_scenario: have the simulation continue with others between two trials.
        scores_alone: whether a trial outside of a study is scored here where no Slicer is
            connected.
        draw_seed: draws the seed of a drill.
    """

    config: Path
    records: Path
    use_settings: Callable[[SimulationSettings], Future[Answer]]
    list_scenarios: Callable[[], Future[list[ListedScenario]]]
    use_scenario: Callable[[str], Future[Answer]]
    is_slicer_connected: Callable[[], bool]
    quit: Callable[[], None]
    draw_seed: Callable[[], int]
    assigned: AssignedTraining = field(default_factory=AssignedTraining)
    scores_alone: bool = False
    pin: InstructorPin | None = None


@dataclass(eq=False)
class SimulationReload:
    """Has the simulation continue with other settings, or on another head, between two trials."""

    _services: FlowServices
    _control_loop: ControlLoop
    _complain: Callable[[str], None]
    _wanted: SimulationSettings | None = None
    _asked: SimulationSettings | None = None
    _begins_in_s: float = 0.0
    _answer: Future[Answer] | None = None

    @property
    def is_under_way(self) -> bool:
        is_ours = self._answer is not None or self._wanted is not None
        return is_ours or self._control_loop.is_being_replaced

    def request(self, present: SimulationSettings, wanted: SimulationSettings) -> None:
        """Continue with other settings, once they have stayed unchanged for a while."""
        is_needed = wanted != present or self._answer is not None
        self._wanted = wanted if is_needed else None
        self._begins_in_s = SET_UP_AFTER_S

    def use_scenario(self, name: str) -> None:
        if self._answer is None:
            self._answer = self._services.use_scenario(name)

    def advance(self, dt: float, has_open_trial: bool) -> None:
        """Advance by `dt` seconds; settings wait for the end of an open trial or of a loading."""
        self._begins_in_s -= dt
        if self._answer is not None and self._answer.done():
            answer, asked = self._answer.result(), self._asked
            self._answer = self._asked = None
            if asked is not None and answer.message in (TRIAL_IS_OPEN, BEING_SET_UP):
                # Somebody else was faster.
                self._wanted = self._wanted or asked
            elif not answer.ok:
                self._complain(answer.message)
        is_free = self._answer is None and not self._control_loop.is_being_replaced
        may_begin = is_free and not has_open_trial and self._begins_in_s <= 0.0
        if self._wanted is not None and may_begin:
            self._answer = self._services.use_settings(self._wanted)
            self._asked, self._wanted = self._wanted, None
