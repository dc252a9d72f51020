"""A few numbers about a trajectory, counted tick by tick while it is replayed."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rastrainer.protocol import Phase, Proximity
from rastrainer_simulator.state import EventKind, SimulationState, StepResult
from rastrainer_simulator.vectors import distance

MM = 1000.0


@dataclass(frozen=True)
class ReplayMetrics:
    """Of one trial, up to its last tick.

    Attributes:
        completion_time_s: trial time of the last kept touch.
        path_mm: way of the tool's tip while the trial ran.
        proximity_s: time with the tool within 20 mm of the head or touching it.
        contacts: how often the tool came to touch the head.
        least_clearance_mm: smallest signed distance of the tool to the head.
        fastest_joint_rad_s: highest speed of any joint.
        rejected: touches that did not count.
        undone: touches that were taken back.
    """

    completion_time_s: float = 0.0
    path_mm: float = 0.0
    proximity_s: float = 0.0
    contacts: int = 0
    least_clearance_mm: float = float("inf")
    fastest_joint_rad_s: float = 0.0
    rejected: int = 0
    undone: int = 0

    def after(self, dt: float, before: SimulationState, result: StepResult) -> ReplayMetrics:
        """Return the metrics with one more tick."""
        state = result.state
        training = state.training
        if Phase.IDLE in (training.phase, before.training.phase):
            return self
        touches = training.touches
        tip, last_tip = (s.tool_tip_to_world[:3, 3].tolist() for s in (state, before))
        speed = max(abs(a - b) for a, b in zip(state.q, before.q, strict=True)) / dt
        contacts = sum(
            event.kind is EventKind.PROXIMITY and event.data["to"] == Proximity.CONTACT.value
            for event in result.events
        )
        return replace(
            self,
            completion_time_s=touches[-1].elapsed if touches else 0.0,
            path_mm=self.path_mm + MM * distance(tip, last_tip),
            proximity_s=self.proximity_s + dt * (state.proximity is not Proximity.FREE),
            contacts=self.contacts + contacts,
            least_clearance_mm=min(self.least_clearance_mm, MM * state.clearance),
            fastest_joint_rad_s=max(self.fastest_joint_rad_s, speed),
            rejected=training.rejected,
            undone=training.undone,
        )
