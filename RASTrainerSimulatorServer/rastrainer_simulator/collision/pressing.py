"""How far the commanded motion has gone into the head beyond where the tool could go.

The head is rigid: a pressed tip rests on the skin and slides, however hard it is pushed. What a
trainee does to a patient by pushing on is measured as in haptic rendering with a god object
(Zilles and Salisbury 1995, 10.1109/IROS.1995.525876): there the tool that is shown stays on the
surface while the hand goes on beneath it, and the distance between the two is the penetration. A
joystick and a jog command velocities and not places, so the way commanded into the skin is summed
up tick by tick; of a move, whose end is known, no more than that end is beneath the skin.

It is a measure only: nothing of the motion follows from it.
"""

from __future__ import annotations

from rastrainer_simulator.collision.clearance import Clearance
from rastrainer_simulator.collision.sliding import REST
from rastrainer_simulator.vectors import Vector, dot, subtract

DEEPEST = 0.010
"""m: pressing farther in counts no more."""


class Pressing:
    """The virtual depth of the tool in the head, all lengths in m.

    Attributes:
        depth: now; 0 without contact.
        deepest: greatest of the contact that lasts, or of the last one.
    """

    def __init__(self) -> None:
        self.depth = 0.0
        self.deepest = 0.0
        self._is_in_contact = False

    def end(self) -> None:
        """Take note that the tool is not in contact."""
        self.depth = 0.0
        self._is_in_contact = False

    def move(
        self,
        commanded: Vector,
        carried_out: Vector,
        clearance: Clearance,
        to_goal: Vector | None = None,
    ) -> None:
        """Take note of a tick at whose end the tool is in contact.

        Args:
            commanded: displacement of the tip that the operator wanted, World.
            carried_out: displacement of the tip that came of it, World.
            clearance: at the tick's end; the part of the tool that is nearer to the head counts.
            to_goal: from the tip to where a commanded move shall end, None without an end.
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
        # What was free and yet not gone, as at the limit of a joint's speed, is not the skin's.
        free = max(nearest.distance_m - REST, 0.0)
        held_back = dot(subtract(carried_out, commanded), nearest.normal) - free
        depth = self.depth + max(min(-outward, held_back), 0.0)
        if to_goal is not None:
            depth = min(depth, max(self.depth, -dot(to_goal, nearest.normal) - free))
        self.depth = min(depth, DEEPEST)
        self.deepest = max(self.deepest, self.depth)
