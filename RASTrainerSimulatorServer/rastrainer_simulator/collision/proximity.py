"""Free, in proximity or in contact, and how deep the commanded motion has gone into the head.

The head is rigid: a pressed tip rests on the skin and slides, however hard it is pushed. The depth
is defined as for a god object in haptic rendering (Zilles and Salisbury 1995,
10.1109/IROS.1995.525876): the visible tool stays on the surface while the hand moves on beneath it,
and their distance is the penetration. A joystick and a jog command velocities, not positions, so
the displacement commanded into the skin is summed up tick by tick; a move cannot get deeper than
its end.

The depth is only measured: it does not influence the motion.
"""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.json_checks import Setting
from rastrainer.motion.trajectory import FAR_MM, NEAR_MM, RELEASED_MM, TOUCHING_MM
from rastrainer.protocol import Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.clearance import Clearance
from rastrainer_simulator.collision.contact import REST
from rastrainer_simulator.vectors import Vector, dot, subtract


@dataclass(frozen=True)
class ProximitySettings:
    """Where the states start and end, in m; with hysteresis, so that none flickers.

    Proximity starts at the clearance `near` of the tip and ends at `far`; contact starts at the
    clearance `touching` of the whole tool and ends at `released`.
    """

    near: Setting = NEAR_MM / MM_PER_M
    far: Setting = FAR_MM / MM_PER_M
    touching: Setting = TOUCHING_MM / MM_PER_M
    released: Setting = RELEASED_MM / MM_PER_M


def next_proximity(
    current: Proximity, clearance: Clearance, settings: ProximitySettings
) -> Proximity:
    """Return the state after a tick, from the state before it and the clearances now."""
    in_contact = current is Proximity.CONTACT
    if clearance.tool_m <= (settings.released if in_contact else settings.touching):
        return Proximity.CONTACT
    is_near = current is not Proximity.FREE
    if clearance.tip_m <= (settings.far if is_near else settings.near):
        return Proximity.PROXIMITY
    return Proximity.FREE


DEEPEST = 0.010
"""Largest depth, m."""


class Pressing:
    """The virtual depth of the tool in the head, m, and the deepest of the last contact."""

    def __init__(self) -> None:
        self.depth = 0.0
        self.deepest = 0.0
        self._is_in_contact = False

    def end(self) -> None:
        self.depth = 0.0
        self._is_in_contact = False

    def move(
        self,
        commanded: Vector,
        carried_out: Vector,
        clearance: Clearance,
        to_goal: Vector | None = None,
    ) -> None:
        """Note a tick at whose end the tool is in contact.

        The displacements are of the tip, World. The part of the tool that is nearer to the head
        counts; `to_goal` leads from the tip to the end of a commanded move.
        """
        if not self._is_in_contact:
            self._is_in_contact, self.deepest = True, 0.0
        nearest = clearance.tip
        if clearance.shaft is not None and clearance.shaft.distance_m < nearest.distance_m:
            nearest = clearance.shaft
        outward = dot(commanded, nearest.normal)
        if outward >= 0.0:
            self.depth = max(self.depth - outward, 0.0)
            return
        # A free displacement that was not carried out, as at a joint's speed limit, is no pressing.
        free = max(nearest.distance_m - REST, 0.0)
        held_back = dot(subtract(carried_out, commanded), nearest.normal) - free
        depth = self.depth + max(min(-outward, held_back), 0.0)
        if to_goal is not None:
            depth = min(depth, max(self.depth, -dot(to_goal, nearest.normal) - free))
        self.depth = min(depth, DEEPEST)
        self.deepest = max(self.deepest, self.depth)
