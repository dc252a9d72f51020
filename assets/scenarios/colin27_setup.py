"""Where the default head stands, how it is looked at and where it comes from."""

from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.files.writing import write_text
from rastrainer.head.trial_head import Perturbation
from rastrainer.scenario.scenario import FORMAT_VERSION

HEAD_CENTER_MM = np.array([480.0, 0.0, 220.0])
"""In World. Nearer, the robot cannot reach the ear on its own side; farther or higher, not the
other one: of a grid of places this leaves most skin touchable in every pose of a trial."""

PERTURBATION = Perturbation(translation_mm=15.0, yaw_deg=8.0, tilt_deg=3.0)

CLOSE_UP_MM = np.array([480.0, -600.0, 440.0])
"""The eye of the default view, in World."""

WINDOW, LEVEL = 188.0, 94.0
"""The display range of the volume's values, as make_colin27.py determines it."""

LANDMARKS = {
    "Nasion": (1.0, 84.4, -40.0),
    "Left tragus": (-86.9, -22.8, -56.3),
    "Right outer canthus": (52.6, 62.0, -42.1),
    "Right inner canthus": (13.6, 72.8, -41.1),
    "Left inner canthus": (-14.5, 70.4, -42.5),
}
"""RAS, mm, found by eye on pictures of the mesh. Those that the robot reaches in every pose of a
trial, the three that a trace begins with first; the right tragus is out of its reach in some poses,
the left outer canthus by some millimeters, and the tip of the nose is not in the images."""

NOTICE = (
    "Copyright (C) 1993–2009 Louis Collins, McConnell Brain Imaging Centre, Montreal Neurological "
    "Institute, McGill University. Permission to use, copy, modify, and distribute this software "
    "and its documentation for any purpose and without fee is hereby granted, provided that the "
    "above copyright notice appear in all copies. The authors and McGill University make no "
    "representations about the suitability of this software for any purpose. It is provided "
    "“as is” without express or implied warranty. The authors are not responsible for any data "
    "loss, equipment damage, property loss, or injury to subjects or patients resulting from the "
    "use or misuse of this software package."
)


def write_table(script: str, table: str) -> None:
    """Print a script's table, and put it into README."""
    readme = Path(__file__).with_name("README.md")
    start, end = f"<!-- table by {script} -->\n", "<!-- end of table -->\n"
    before, _, rest = readme.read_text(encoding="utf-8").partition(start)
    write_text(readme, before + start + table + end + rest.partition(end)[2])
    print(table)


def head_to_world(center_ras: np.ndarray) -> np.ndarray:
    """Return the nominal pose (4, 4), mm: upright, the face to −y, the right side to the robot."""
    pose = np.diag([-1.0, -1.0, 1.0, 1.0])
    pose[:3, 3] = HEAD_CENTER_MM - pose[:3, :3] @ center_ras
    return pose


def scenario_json(center_ras: np.ndarray, tasks: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the content of `scenario.json`; the head's center is (3,) float, RAS mm."""
    return {
        "formatVersion": FORMAT_VERSION,
        "name": "colin27",
        "title": "Colin27 head",
        "head": "head.ply",
        "target": {"name": "Center of the head", "positionRas": _listed(center_ras)},
        "headToWorld": _listed(head_to_world(center_ras).ravel()),
        "perturbation": {
            "translationMm": PERTURBATION.translation_mm,
            "yawDeg": PERTURBATION.yaw_deg,
            "tiltDeg": PERTURBATION.tilt_deg,
        },
        "tasks": tasks,
        "landmarks": [
            {"name": name, "positionRas": list(place)} for name, place in LANDMARKS.items()
        ],
        "cameras": {
            "close-up": _camera(CLOSE_UP_MM, [480.0, 0.0, 225.0], 30.0),
            "far": _camera(np.array([240.0, -2050.0, 1050.0]), [240.0, 0.0, 430.0], 32.0),
        },
        "table": {"centerMm": [300.0, 0.0], "sizeMm": [1300.0, 1000.0, 40.0]},
        "stand": {"diameterMm": 80.0},
        "volume": {"file": "volume.nrrd", "window": WINDOW, "level": LEVEL},
        "provenance": {
            "source": "Colin27, an average of 27 T1-weighted MRI scans of one person (Holmes et "
            "al. 1998, doi:10.1097/00004728-199803000-00032), as the volume ch2.nii.gz of "
            "Debian's package mricron-data.",
            "method": "Surface of the skin by assets/scenarios/make_colin27.py, cut flat at the "
            "lower edge of the volume. Where the volume cuts the nose and the ears, the surface "
            "goes on for some millimeters by its own trend.",
            "license": NOTICE,
        },
    }


def _camera(position: np.ndarray, focal_point: list[float], view_angle: float) -> dict[str, Any]:
    return {
        "positionMm": position.tolist(),
        "focalPointMm": focal_point,
        "viewUp": [0.0, 0.0, 1.0],
        "viewAngleDeg": view_angle,
    }


def _listed(values: np.ndarray) -> list[float]:
    return [round(float(value), 4) + 0.0 for value in values]
