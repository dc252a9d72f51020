"""Free, in proximity or in contact: what the trainee sees, hears and feels of the clearance."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.motion.trajectory import FAR_MM, NEAR_MM, RELEASED_MM, TOUCHING_MM
from rastrainer.protocol import Proximity
from rastrainer.units import MM_PER_M
from rastrainer_simulator.collision.clearance import Clearance


@dataclass(frozen=True)
class ProximitySettings:
    """Where the states begin and end, in m; each ends later than it begins, so that none flickers.

    Attributes:
        near: radius of the sphere about the tip within which the head is in proximity.
        far: clearance of the tip at which proximity ends.
        touching: clearance of tip or shaft at which contact begins.
        released: clearance of the whole tool at which contact ends.
    """

    near: float = NEAR_MM / MM_PER_M
    far: float = FAR_MM / MM_PER_M
    touching: float = TOUCHING_MM / MM_PER_M
    released: float = RELEASED_MM / MM_PER_M


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
