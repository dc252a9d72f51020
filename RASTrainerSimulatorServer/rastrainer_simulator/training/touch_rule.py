"""Which touch counts: on the skin, and near enough to the fiducial that is next."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rastrainer.protocol import TouchRule
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.vectors import Vector, distance


@dataclass(frozen=True)
class TrainingSettings:
    """What counts as a touch.

    Attributes:
        acceptance_radius: the longest distance of the tip to the fiducial, m.
        touch_rule: whether the tip has to be on the skin.
        skin_tolerance: the longest distance of the tip to the skin at which it is on it, m.
    """

    acceptance_radius: float = 0.010
    touch_rule: TouchRule = TouchRule.ON_SKIN
    skin_tolerance: float = 0.0005


@dataclass(frozen=True)
class TouchMoment:
    """When and where a command is carried out.

    Attributes:
        sim_time: simulated time, s.
        tip: position of the tool's tip, World, m.
        tip_clearance: signed distance of the tip to the skin, m; below 0 within the head.
        depth: how far the tip is pressed in, m; see `SimulationState.depth`.
    """

    sim_time: float
    tip: Vector
    tip_clearance: float
    depth: float = 0.0


def refused_touch(
    now: TouchMoment,
    next_point: str,
    fiducials: Mapping[str, Vector],
    settings: TrainingSettings,
    texts: Texts,
) -> str | None:
    """Return why a touch does not count, None where it does.

    Args:
        now: where the tip is.
        next_point: label of the fiducial that is next.
        fiducials: label → position, World, m.
        settings: what counts as a touch.
        texts: the sentences.
    """
    away, radius = distance(now.tip, fiducials[next_point]), settings.acceptance_radius
    if away > radius:
        label = min(fiducials, key=lambda key: distance(now.tip, fiducials[key]))
        nearest = distance(now.tip, fiducials[label])
        if nearest <= radius:
            return texts.say(
                "wrong point", point=next_point, label=label, nearest=MM_PER_M * nearest
            )
        return texts.say(
            "too far", point=next_point, distance=MM_PER_M * away, radius=MM_PER_M * radius
        )
    is_above = now.tip_clearance > settings.skin_tolerance
    if settings.touch_rule is TouchRule.ON_SKIN and is_above:
        return texts.say("above the skin", point=next_point, height=MM_PER_M * now.tip_clearance)
    return None
