"""Which touch counts: the one near enough to the fiducial that is next."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer_simulator.texts.texts import Texts
from rastrainer_simulator.vectors import Vector, distance

MM = 1000.0


def refused_touch(
    tip: Vector,
    next_point: str,
    fiducials: Mapping[str, Vector],
    acceptance_radius: float,
    texts: Texts,
) -> str | None:
    """Return why a touch does not count, None where it does.

    Args:
        tip: where the tool's tip is, World, m.
        next_point: label of the fiducial that is next.
        fiducials: label → position, World, m.
        acceptance_radius: how far from its fiducial a touch may be, m.
        texts: says the sentence.
    """
    away = distance(tip, fiducials[next_point])
    if away <= acceptance_radius:
        return None
    label = min(fiducials, key=lambda key: distance(tip, fiducials[key]))
    nearest = distance(tip, fiducials[label])
    if label != next_point and nearest <= acceptance_radius:
        return texts.say("wrong point", point=next_point, label=label, nearest=MM * nearest)
    return texts.say("too far", point=next_point, distance=MM * away, radius=MM * acceptance_radius)
