"""The drill and the instrument in the locked guide: how far they go in, tick by tick.

Rigid geometry: the drill passes everything, the instrument everything but bone that is not drilled
through. Nothing of tissue mechanics is simulated.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from rastrainer.journal.entries import Ahead
from rastrainer.json_checks import Setting
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import OperatorInput
from rastrainer_simulator.teleoperation.teleoperation import StickResponse

LONGEST_FEED_M = 0.25
"""How far drill and instrument reach beyond the guide's tip."""


@dataclass(frozen=True)
class ProcedureSettings:
    """How a procedure is carried out.

    A touch may be `checkpoint_radius` (m) from its checkpoint, by the registration in use.
    The speeds are the fastest feed, m/s; the fine speeds while the trigger for fine speed is held.
    """

    self_alignment: bool = True
    checkpoint_radius: Setting = 0.030
    drill_speed: Setting = 0.005
    fine_drill_speed: Setting = 0.001
    insertion_speed: Setting = 0.010
    fine_insertion_speed: Setting = 0.001

    def fastest(self, phase: Phase, fine: bool) -> float:
        if phase is Phase.DRILLING:
            return self.fine_drill_speed if fine else self.drill_speed
        return self.fine_insertion_speed if fine else self.insertion_speed


class FeedLayer(str, Enum):
    """The layer that the drill cuts or the instrument meets, as a hand feels it.

    `THROUGH` is past the inner table, `BLOCKED` an instrument that stands on uncut bone.
    """

    FREE = "free"
    SCALP = "scalp"
    BONE = "bone"
    THROUGH = "through"
    BLOCKED = "blocked"


@dataclass(frozen=True)
class HeadAhead:
    """Surfaces ahead along the guide's axis: distances from its tip, m, None if missed.

    `outer` is where the axis enters the skull, `inner` where it leaves it. Only the simulator knows
    them; the trainee feels them.
    """

    skin: float | None = None
    outer: float | None = None
    inner: float | None = None

    def recorded(self) -> Ahead:
        distances = (self.skin, self.outer, self.inner)
        return Ahead(*(None if m is None else MM_PER_M * m for m in distances))


@dataclass(frozen=True)
class Feed:
    """How far the instrument is beyond the guide's tip, m; `drilled` is the drill's deepest."""

    depth: float = 0.0
    drilled: float = 0.0
    ahead: HeadAhead = HeadAhead()

    @property
    def has_cut_bone(self) -> bool:
        return self.ahead.outer is not None and self.drilled > self.ahead.outer

    @property
    def is_through(self) -> bool:
        """Whether no uncut bone blocks an instrument."""
        ahead = self.ahead
        return ahead.outer is None or (ahead.inner is not None and self.drilled >= ahead.inner)

    @property
    def instrument_limit(self) -> float:
        if self.is_through:
            return LONGEST_FEED_M
        assert self.ahead.outer is not None, "without bone it is through"
        return max(self.drilled, self.ahead.outer)

    def moved(self, phase: Phase, way: float) -> Feed:
        if phase is Phase.DRILLING:
            depth = min(max(self.depth + way, 0.0), LONGEST_FEED_M)
            return replace(self, depth=depth, drilled=max(self.drilled, depth))
        depth = min(max(self.depth + way, 0.0), self.instrument_limit)
        return replace(self, depth=depth)

    def layer(self, phase: Phase) -> FeedLayer:
        ahead = self.ahead
        if phase is Phase.DRILLING:
            if ahead.inner is not None and self.drilled >= ahead.inner:
                return FeedLayer.THROUGH
            if self.has_cut_bone:
                return FeedLayer.BONE
            is_in_scalp = ahead.skin is not None and self.drilled > ahead.skin
            return FeedLayer.SCALP if is_in_scalp else FeedLayer.FREE
        is_blocked = not self.is_through and self.depth >= self.instrument_limit
        return FeedLayer.BLOCKED if is_blocked else FeedLayer.FREE


NO_FEED = Feed()
"""Nothing is in the guide."""


class FeedDrive:
    """Turns the stick, or a commanded feed, into the distance of a tick."""

    def __init__(self, settings: ProcedureSettings, response: StickResponse) -> None:
        """`response` belongs to the sticks that move the arm."""
        self._settings = settings
        self._response = response
        self._velocity = 0.0
        self._remaining = 0.0

    def start(self, velocity_mm_s: float, duration_s: float) -> None:
        """Feed at a velocity, inward above 0, for a time; the stick overrides it."""
        self._velocity, self._remaining = velocity_mm_s / MM_PER_M, duration_s

    def stop(self) -> None:
        self._remaining = 0.0

    def way(self, dt: float, phase: Phase, operator_input: OperatorInput) -> tuple[float, bool]:
        """Return how far to feed in a tick, m, inward above 0, and whether the stick does it."""
        up = self._response(operator_input.translation)[2]
        fastest = self._settings.fastest(phase, operator_input.fine)
        if up != 0.0:
            self.stop()
            return -up * fastest * dt, True
        if self._remaining <= 1e-3 * dt:
            return 0.0, False
        time = min(dt, self._remaining)
        self._remaining -= dt
        fastest = self._settings.fastest(phase, fine=False)
        return min(max(self._velocity, -fastest), fastest) * time, False
