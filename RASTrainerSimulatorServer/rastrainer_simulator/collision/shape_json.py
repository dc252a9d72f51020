"""A robot's shape as JSON, exact to the last bit."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rastrainer_simulator.collision.capsules import Capsule
from rastrainer_simulator.collision.robot_shape import LinkShape, RobotShape


def shape_to_json(shape: RobotShape) -> dict[str, Any]:
    """Return a shape as a JSON object."""
    links = [_link_to_json(link) for link in shape.links]
    return {"links": links, "tool": _link_to_json(shape.tool), "tipName": shape.tip_name}


def shape_from_json(value: Mapping[str, Any]) -> RobotShape:
    """Return the shape that a JSON object holds."""
    links = tuple(_link_from_json(link) for link in value["links"])
    return RobotShape(links, _link_from_json(value["tool"]), value["tipName"])


def _link_to_json(link: LinkShape) -> dict[str, Any]:
    capsules = [
        {"start": capsule.start.tolist(), "end": capsule.end.tolist(), "radius": capsule.radius}
        for capsule in link.capsules
    ]
    return {"name": link.name, "joint": link.joint, "capsules": capsules}


def _link_from_json(value: Mapping[str, Any]) -> LinkShape:
    capsules = tuple(
        Capsule(np.array(found["start"]), np.array(found["end"]), found["radius"])
        for found in value["capsules"]
    )
    return LinkShape(value["name"], value["joint"], capsules)
