"""Turns the operator's sticks and commands into the target of the tool's tip after this tick."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from rastrainer.json_checks import Setting
from rastrainer_simulator.state import Motion, OperatorInput
from rastrainer_simulator.teleoperation.commanded_motion import CommandedMotion, MotionOutcome
from rastrainer_simulator.teleoperation.steering import (
    Axes,
    NearestSurface,
    SteeringSettings,
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

    The `dead_zone`, a share of the stick's travel, is round, so that a diagonal deflection is not
    bent toward an axis. An `exponent` above 1 makes the response gentler near the center.
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
    """The tool's tip in World, m, the unit vector from A7 to it, and its x axis."""

    position: Vector
    direction: Vector
    across: Vector


@dataclass(frozen=True)
class MotionRequest:
    """The operator's request for this tick: the tip's displacement, m, World.

    `direction` is the tool's, None if it is free, `across` its tip's x axis, None if it may roll.
    `goal` is the end of the motion, m, World, None if no position is commanded.
    """

    motion: Motion
    displacement: Vector = ZERO
    direction: Vector | None = None
    across: Vector | None = None
    ended: MotionOutcome | None = None
    goal: Vector | None = None


class Teleoperation:
    """Turns sticks and commanded motions into the tip's displacement, tick by tick.

    A request always starts from where the tip is: nothing builds up while the head or a joint's
    speed limit stops the tool, and the arm stops in the tick in which the stick is released.
    """

    def __init__(self, settings: TeleoperationSettings) -> None:
        self._settings = settings
        self.steering = ToolSteering(settings.steering)
        self._velocity = ZERO
        self._running: CommandedMotion | None = None

    def start(self, motion: CommandedMotion) -> None:
        self._running = motion

    def stop(self) -> bool:
        """Stand still and forget held directions; return whether a commanded motion ended by it."""
        was_running = self._running is not None
        self._running = None
        self._velocity = ZERO
        self.steering.reset()
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
        settings, steering, running = self._settings, self.steering, self._running
        push = vector(settings.response(operator_input.translation))
        turn = STRAIGHT
        if steering.is_steered:
            sideways, ahead = settings.response(operator_input.rotation)
            turn = (sideways, ahead)
        is_fine = operator_input.fine
        direction: Vector | None
        if push != ZERO or turn != STRAIGHT:
            self._running = None
            motion, goal = Motion.STICK, None
            ended = MotionOutcome.OVERRIDDEN if running else None
            self._push(dt, push, is_fine, axes, surface)
            displacement = scale(self._velocity, dt)
            direction = steering.steer(dt, turn, is_fine, axes, tip.direction, surface)
        else:
            ended = running.outcome(dt, tip.position, tip.direction) if running else None
            if running is None or ended is not None:
                self._running = None
                self._velocity = ZERO
                return MotionRequest(Motion.NONE, ended=ended)
            motion, goal = running.motion, running.goal
            displacement = running.displacement(
                dt, tip.position, self._velocity, settings.acceleration
            )
            self._velocity = scale(displacement, 1.0 / dt)
            if running.direction is not None:
                direction = steering.turn_to(tip.direction, running.direction, dt)
            else:
                direction = steering.steer(dt, STRAIGHT, False, axes, tip.direction, surface)
        across = steering.across(direction, tip.direction, tip.across) if direction else None
        return MotionRequest(motion, displacement, direction, across, ended, goal)

    def _push(
        self,
        dt: float,
        push: Vector,
        is_fine: bool,
        axes: Axes,
        surface: NearestSurface | None,
    ) -> None:
        """Change the velocity by the stick's response; slow motion is limited near the skin."""
        settings = self._settings
        fastest = settings.fine_speed if is_fine else settings.coarse_speed
        wanted = axes.to_world(scale(push, fastest))
        if is_fine and surface is not None:
            above = surface.clearance
            limit = _between(settings.skin_speed, settings.fine_speed, above, AT_SKIN_M)
            landing = _between(settings.landing_speed, settings.fine_speed, above, LANDING_M)
            inward = max(0.0, -dot(unit(wanted), surface.normal))
            wanted = shortened(wanted, min(limit, landing / max(inward, 1e-9)))
        faster = accelerated(self._velocity, wanted, settings.acceleration * dt)
        self._velocity = ZERO if push == ZERO else faster


def _between(slowest: float, fastest: float, clearance: float, at: float) -> float:
    """Return a limit that grows from `at` a clearance (m) until `OFF_SKIN_M`, m/s."""
    share = (clearance - at) / (OFF_SKIN_M - at)
    return min(slowest, fastest) + min(max(share, 0.0), 1.0) * max(0.0, fastest - slowest)
