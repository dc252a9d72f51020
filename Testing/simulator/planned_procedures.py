"""The default head with a made-up skull, two spheres, and procedures on straight lines."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer.head.mesh import HeadMesh, write_head_mesh
from rastrainer.protocol import TouchRule
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from Testing.domain.head.spheres import RADIUS_MM, sphere_mesh

OUTER_MM, INNER_MM = 68.0, 62.0
"""Radii of the made-up tables of the skull about the head's target, as far as triangles go."""
ENTRIES = ((25.0, -15.0, 78.0), (-25.0, -25.0, 76.0), (5.0, 30.0, 72.0))
TARGETS = ((8.0, -20.0, 5.0), (-8.0, -18.0, 6.0), (2.0, -10.0, 12.0))
CHECKPOINTS = ((0.0, -15.0, 85.0), (40.0, -10.0, 70.0), (-40.0, -10.0, 70.0))


def shell(middle, outer=OUTER_MM, inner=INNER_MM) -> HeadMesh:
    """Return a spherical skull: its outer table, and its inner one turned inside out."""
    ball = sphere_mesh(3)
    unit = ball.vertices / RADIUS_MM
    vertices = np.concatenate([middle + outer * unit, middle + inner * unit])
    inside = ball.triangles[:, ::-1] + len(unit)
    return HeadMesh(vertices, np.concatenate([ball.triangles, inside]))


def procedure(name, kind, count, checkpoints=CHECKPOINTS):
    """Return the entry of a procedure in `scenario.json`."""
    return {
        "name": name,
        "title": name.title(),
        "kind": kind,
        "source": "made up",
        "trajectories": [
            {
                "name": f"Line {number}",
                "entryRas": list(ENTRIES[number]),
                "targetRas": list(TARGETS[number]),
                "diameterMm": 1.3,
                "safetyMm": 2.0,
            }
            for number in range(count)
        ],
        "noGo": [],
        "checkpoints": [
            {"name": f"Check {number}", "positionRas": list(place)}
            for number, place in enumerate(checkpoints)
        ],
    }


def write_scenario(folder: Path) -> Path:
    """Write the default scenario with procedures into a new folder, and return it."""
    default = asset_path("scenarios", "colin27")
    folder.mkdir()
    shutil.copy(default / "head.ply", folder)
    shutil.copytree(default / "tasks", folder / "tasks")
    values = json.loads((default / "scenario.json").read_text())
    values.pop("volume", None)
    values["skull"] = {"file": "skull.ply", "kind": "approximation"}
    values["procedures"] = [
        procedure("dbs", "dbs", 2),
        procedure("seeg", "seeg", 3),
        procedure("biopsy", "biopsy", 1, ()),
    ]
    middle = np.array(values["target"]["positionRas"])
    write_head_mesh(folder / "skull.ply", shell(middle))
    (folder / "scenario.json").write_text(json.dumps(values, indent=2) + "\n")
    return folder


def procedure_setup(folder: Path, touch_rule=TouchRule.WITHIN_RADIUS) -> SimulationSetup:
    """Return a setup in which a touch counts wherever the tip is, unless the rule says more."""
    setup = load_setup(write_scenario(folder))
    settings = setup.settings
    training = replace(settings.training, acceptance_radius=10.0, touch_rule=touch_rule)
    wide = replace(settings.procedure, checkpoint_radius=10.0)
    return replace(setup, settings=replace(settings, training=training, procedure=wide))
