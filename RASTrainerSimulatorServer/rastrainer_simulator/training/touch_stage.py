"""How the next touch is going: far, near, on the skin where it counts, or wrong."""

from __future__ import annotations

from rastrainer.motion.trajectory import RELEASED_MM
from rastrainer.protocol import Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import TouchStage, TrainingState
from rastrainer_simulator.training.rules import TouchMoment, TrainingSettings
from rastrainer_simulator.vectors import Vector, distance

TOO_DEEP_MM = 0.5
"""How deep the tip may be pressed in before that is an error."""


def touch_stage(
    now: TouchMoment,
    proximity: Proximity,
    obstacle: str,
    training: TrainingState,
    goal: Vector | None,
    settings: TrainingSettings,
) -> TouchStage:
    """Return how the next touch is going.

    Args:
        now: where the tip is.
        proximity: of the tool to the head.
        obstacle: what stops the arm behind the tool, "" for nothing.
        training: where the trial stands.
        goal: position of the next fiducial, World, m; None without one.
        settings: what counts as a touch.
    """
    if proximity is not Proximity.CONTACT:
        if obstacle:
            return TouchStage.ARM
        return TouchStage.FAR if proximity is Proximity.FREE else TouchStage.NEAR
    if MM_PER_M * now.depth > TOO_DEEP_MM:
        return TouchStage.TOO_DEEP
    if MM_PER_M * now.tip_clearance > RELEASED_MM:
        return TouchStage.SHAFT
    if obstacle:
        return TouchStage.ARM
    radius = settings.acceptance_radius
    if goal is not None and distance(now.tip, goal) <= radius:
        is_on_skin = now.tip_clearance <= settings.skin_tolerance
        return TouchStage.ON_SKIN if is_on_skin else TouchStage.NEAR
    # The tip still is where the last touch was made, or no trial is open.
    is_just_touched = any(distance(now.tip, t.position) <= radius for t in training.touches[-1:])
    is_open = training.phase in (Phase.RUNNING, Phase.COMPLETE)
    return TouchStage.ELSEWHERE if is_open and not is_just_touched else TouchStage.NEAR
