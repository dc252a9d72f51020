"""From the operator's sticks and commands to the target of the tool's tip after this tick."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

from rastrainer.json_checks import Setting
from rastrainer_simulator.state import Motion, OperatorInput
from rastrainer_simulator.teleoperation.commanded_motion import CommandedMotion, MotionOutcome
from rastrainer_simulator.teleoperation.steering import (
    Axes,
    NearestSurface,
    SteeringSettings,
    ToolDirection,
    ToolSteering,
)
from rastrainer_simulator.vectors import (
    ZERO,
    Vector,
    accelerated,
    dot,
    scale,
    shortened,
    unit,
    vector,
)


@dataclass(frozen=True)
class StickResponse:
    """How a stick's deflection becomes a speed.

    Attributes:
        dead_zone: share of the stick's travel that counts as released, 0…1. The zone is round, so
            that a diagonal deflection is not bent toward an axis.
        exponent: of the response curve; 1 is linear, larger is gentler near the center.
    """

    dead_zone: Setting = 0.12
    exponent: Setting = 2.0

    def __call__(self, deflection: tuple[float, ...]) -> tuple[float, ...]:
        """Return the share of the full speed along each axis, its length 0…1.

        Values that are not finite count as released: a broken gamepad must not move the arm.
        """
        size = math.hypot(*deflection)
        if not self.dead_zone < size < math.inf:
            return (0.0,) * len(deflection)
        share = min(1.0, (size - self.dead_zone) / (1.0 - self.dead_zone)) ** self.exponent
        return tuple(value * share / size for value in deflection)


AT_SKIN_M, LANDING_M, OFF_SKIN_M = 0.002, 0.0005, 0.01
"""Up to the first clearance of the tip slow motion is limited most, up to the second that toward
the skin; from the third on neither is."""
STRAIGHT = (0.0, 0.0)
"""The steering stick at rest."""


@dataclass(frozen=True)
class TeleoperationSettings:
    """How the arm answers to the operator.

    Attributes:
        coarse_speed: of the tip at full deflection, m/s.
        fine_speed: the same while the trigger for fine speed is held, m/s.
        skin_speed: the fastest slow motion at the skin, m/s.
        landing_speed: the same toward the skin. People react 0.25 s after the tip has reached it,
            and within 0.5 s at the latest: by then it is pressed in by no more than 0.5 mm.
        acceleration: of the tip at most, m/s²; a released stick stops it immediately.
    """

    response: StickResponse = field(default_factory=StickResponse)
    coarse_speed: Setting = 0.15
    fine_speed: Setting = 0.02
    skin_speed: Setting = 0.003
    landing_speed: Setting = 0.001
    acceleration: Setting = 2.0
    steering: SteeringSettings = field(default_factory=SteeringSettings)


@dataclass(frozen=True)
class Tip:
    """The tool's tip in World.

    Attributes:
        position: m.
        direction: unit vector from A7 to the tip.
        across: the tip's x axis, a unit vector.
    """

    position: Vector
    direction: Vector
    across: Vector


@dataclass(frozen=True)
class MotionRequest:
    """The operator's request for this tick.

    Attributes:
        motion: its source; NONE keeps the arm still.
        displacement: of the tip, m, World.
        direction: of the tool, unit vector; None if it is free.
        across: the x axis of the tool's tip, unit vector; None if the tool may roll.
        goal: end of the motion, m, World; None if no position is commanded.
    """

    motion: Motion
    displacement: Vector = ZERO
    direction: Vector | None = None
    across: Vector | None = None
    ended: MotionOutcome | None = None
    goal: Vector | None = None


class Teleoperation:
    """Turns sticks and commanded motions into the tip's displacement, tick by tick.

    A request always starts from where the tip is, not from where it should have been: nothing
    builds up while the tool is stopped by the head or by a joint's speed limit, and the arm stops
    in the tick in which the stick is released.
    """

    def __init__(self, settings: TeleoperationSettings) -> None:
        self._settings = settings
        self._as_set = ToolSteering(settings.steering)
        self._held = ToolSteering(replace(settings.steering, choice=ToolDirection.HELD))
        self._steering = self._as_set
        self._velocity = ZERO
        self._running: CommandedMotion | None = None

    def hold_direction(self, is_held: bool) -> None:
        """Have the operator hold and steer the tool's direction, whatever is set."""
        steering = self._held if is_held else self._as_set
        if steering is not self._steering:
            steering.reset()
            self._steering = steering

    def start(self, motion: CommandedMotion) -> None:
        self._running = motion

    def stop(self) -> bool:
        """Stand still and forget held directions; return whether a commanded motion ended by it."""
        was_running = self._running is not None
        self._running = None
        self._velocity = ZERO
        self._steering.reset()
        return was_running

    def step(
        self,
        dt: float,
        operator_input: OperatorInput,
        tip: Tip,
        axes: Axes,
        surface: NearestSurface | None = None,
    ) -> MotionRequest:
        """Return what the operator wants of the next `dt` seconds.

        The sticks override a commanded motion. `surface` is the head near the tip, for a tool that
        comes down along the surface normal.
        """
        response = self._settings.response
        push = vector(response(operator_input.translation))
        turn = STRAIGHT
        if self._steering.is_steered:
            sideways, ahead = response(operator_input.rotation)
            turn = (sideways, ahead)
        if push != ZERO or turn != STRAIGHT:
            ended = MotionOutcome.OVERRIDDEN if self._running else None
            self._running = None
            settings = self._settings
            fastest = settings.fine_speed if operator_input.fine else settings.coarse_speed
            wanted = axes.to_world(scale(push, fastest))
            if operator_input.fine and surface is not None:
                wanted = self._slowed(wanted, surface)
            faster = accelerated(self._velocity, wanted, settings.acceleration * dt)
            self._velocity = ZERO if push == ZERO else faster
            is_fine = operator_input.fine
            direction = self._steering.steer(dt, turn, is_fine, axes, tip.direction, surface)
            return self._toward(Motion.STICK, scale(self._velocity, dt), direction, tip, ended)
        if self._running is None:
            self._velocity = ZERO
            return MotionRequest(Motion.NONE)
        outcome = self._running.outcome(dt, tip.position, tip.direction)
        if outcome is not None:
            self._running = None
            self._velocity = ZERO
            return MotionRequest(Motion.NONE, ended=outcome)
        return self._by_command(self._running, dt, tip, axes, surface)

    def _slowed(self, wanted: Vector, surface: NearestSurface) -> Vector:
        """Return the velocity of slow motion (m/s) near the skin; its direction is kept."""
        settings, above = self._settings, surface.clearance
        limit = _between(settings.skin_speed, settings.fine_speed, above, AT_SKIN_M)
        landing = _between(settings.landing_speed, settings.fine_speed, above, LANDING_M)
        inward = max(0.0, -dot(unit(wanted), surface.normal))
        return shortened(wanted, min(limit, landing / max(inward, 1e-9)))

    def _by_command(
        self,
        running: CommandedMotion,
        dt: float,
        tip: Tip,
        axes: Axes,
        surface: NearestSurface | None,
    ) -> MotionRequest:
        displacement = running.displacement(
            dt, tip.position, self._velocity, self._settings.acceleration
        )
        self._velocity = scale(displacement, 1.0 / dt)
        direction: Vector | None
        if running.direction is not None:
            direction = self._steering.turn_to(tip.direction, running.direction, dt)
        else:
            direction = self._steering.steer(dt, STRAIGHT, False, axes, tip.direction, surface)
        return self._toward(running.motion, displacement, direction, tip, goal=running.goal)

    def _toward(
        self,
        motion: Motion,
        displacement: Vector,
        direction: Vector | None,
        tip: Tip,
        ended: MotionOutcome | None = None,
        goal: Vector | None = None,
    ) -> MotionRequest:
        steering = self._steering
        across = steering.across(direction, tip.direction, tip.across) if direction else None
        return MotionRequest(motion, displacement, direction, across, ended, goal)


def _between(slowest: float, fastest: float, clearance: float, at: float) -> float:
    """Return a limit that grows from `at` a clearance (m) until `OFF_SKIN_M`, m/s."""
    share = (clearance - at) / (OFF_SKIN_M - at)
    return min(slowest, fastest) + min(max(share, 0.0), 1.0) * max(0.0, fastest - slowest)
