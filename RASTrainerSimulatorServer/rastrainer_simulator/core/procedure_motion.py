"""What moves in a procedure besides the arm: drill and instrument; and how the guide is aligned."""

from __future__ import annotations

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.head_outline import HeadOutline
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.core.true_head import TrueHead
from rastrainer_simulator.operator_input import OperatorInput
from rastrainer_simulator.procedure_state import GuideAxis, ProcedureState
from rastrainer_simulator.state import Event, EventKind
from rastrainer_simulator.teleoperation.commanded_motion import PathCommand
from rastrainer_simulator.teleoperation.guide_path import guide_path
from rastrainer_simulator.training.feed import NO_FEED, Feed, FeedDrive
from rastrainer_simulator.training.registered_plan import RegisteredPlan
from rastrainer_simulator.vectors import Vector, dot, vector

FED = (Phase.DRILLING, Phase.INSERTING)
"""The arm is held, and the instrument in the guide moves."""


class ProcedureMotion:
    """The feed of drill and instrument, and the geometry that a procedure needs of the head.

    Attributes:
        feed: what is in the guide.
    """

    def __init__(self, setup: SimulationSetup, head: HeadMesh) -> None:
        """`head` is the scenario's; without procedures nothing is made of it."""
        settings, scenario = setup.settings, setup.scenario
        self.feed = NO_FEED
        self._drive = FeedDrive(settings.procedure, settings.teleoperation.response)
        self._true_head: TrueHead | None = None
        self._outline: HeadOutline | None = None
        if scenario.procedures:
            self._true_head = TrueHead(scenario, head)
            self._outline = HeadOutline(head.vertices, scenario.target_position)

    def reset(self, feed: Feed = NO_FEED) -> None:
        """Take on a feed, and end a commanded one."""
        self.feed = feed
        self._drive.stop()

    def looking_ahead(self, guide: GuideAxis, head_to_world: np.ndarray) -> Feed:
        """Return the feed of a guide that is to be locked: with what truly lies ahead of it."""
        assert self._true_head is not None, "the phase has a procedure"
        return Feed(ahead=self._true_head.ahead(guide, head_to_world))

    def start(self, velocity_mm_s: float, duration_s: float) -> None:
        """Feed at a velocity, inward above 0, for a time; the stick overrides it."""
        self._drive.start(velocity_mm_s, duration_s)

    def step(
        self, dt: float, phase: Phase, operator_input: OperatorInput, sim_time: float
    ) -> tuple[Event, ...]:
        """Feed for `dt` s; return an event where what is felt changes."""
        before = self.feed
        self.feed = before.moved(phase, self._drive.way(dt, phase, operator_input))
        layer = self.feed.layer(phase)
        if layer is before.layer(phase):
            return ()
        data = {
            "phase": phase.value,
            "layer": layer.value,
            "feedMm": MM_PER_M * self.feed.depth,
        }
        return (Event(EventKind.FEED, sim_time, data),)

    def stop(self) -> None:
        """End a commanded feed, as a pause does."""
        self._drive.stop()

    def path(self, guide: GuideAxis, procedure: ProcedureState, stand_off: float) -> PathCommand:
        """Return the robot's own way onto the planned line at hand, by the registration in use.

        Args:
            guide: where it is now.
            procedure: in the phase `aligning`.
            stand_off: of the tip before the line's entry at the end, m.
        """
        registration, present, outline = procedure.registration, procedure.present, self._outline
        assert registration is not None, "it is accepted"
        assert present is not None, "the phase has a trajectory"
        assert outline is not None, "the phase has a procedure"
        plan = RegisteredPlan.of(registration.matrix)
        assert plan is not None, "what is in use is rigid"

        def radius(direction: Vector) -> float:
            return outline.radius(vector(dot(row, direction) for row in plan.rows))

        middle = plan.in_world(outline.middle.tolist())
        return guide_path(guide, present.line, stand_off, middle, radius)
