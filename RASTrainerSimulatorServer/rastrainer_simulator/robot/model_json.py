"""A robot's model as JSON, exact to the last bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer_simulator.robot.mesh_files import MeshPart, mesh_inside
from rastrainer_simulator.robot.model import Joint, Link, RobotModel, make_model


def model_to_json(model: RobotModel, folder: Path) -> dict[str, Any]:
    """Return a model as a JSON object; its mesh files are named from `folder` on."""
    meshes = [asdict(part) | {"path": part.path.relative_to(folder)} for part in model.meshes]
    return {
        "name": model.name,
        "tip": model.tip.name,
        "joints": [_plain(asdict(joint)) for joint in model.joints],
        "links": [_plain(asdict(link)) for link in model.links],
        "meshes": [_plain(mesh) for mesh in meshes],
    }


def model_from_json(value: Mapping[str, Any], folder: Path) -> RobotModel:
    """Return the model that a JSON object holds; its mesh files are below `folder`."""
    joints = tuple(Joint(**_arrays(joint, "origin", "axis")) for joint in value["joints"])
    links = tuple(Link(**_arrays(link, "offset")) for link in value["links"])
    meshes = tuple(
        MeshPart(
            **_arrays(part, "origin")
            | {"path": mesh_inside(folder, folder / part["path"], part["link"])}
            | {name: tuple(part[name]) for name in ("scale", "color")}
        )
        for part in value["meshes"]
    )
    return make_model(value["name"], joints, links, value["tip"], meshes)


def _plain(value: Mapping[str, Any]) -> dict[str, Any]:
    return {name: _plain_part(part) for name, part in value.items()}


def _plain_part(part: Any) -> Any:
    if isinstance(part, np.ndarray):
        return part.tolist()
    return part.as_posix() if isinstance(part, Path) else part


def _arrays(value: Mapping[str, Any], *names: str) -> dict[str, Any]:
    arrays = {name: np.array(value[name]) for name in names}
    for array in arrays.values():
        array.setflags(write=False)
    return {**value, **arrays}
