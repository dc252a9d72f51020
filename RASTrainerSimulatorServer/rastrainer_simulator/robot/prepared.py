"""What a robot's URDF and collision meshes come to, written down beside them.

The packages that read these files take a second to import and 90 MB. A robot that is prepared
starts without them; one that is not, or whose files have changed since, is read as ever.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files import read_json

FILE_NAME = "prepared.json"
MOST_BYTES = 2**20


def read_prepared(urdf: Path) -> Mapping[str, Any] | None:
    """Return what is written beside a URDF, None where nothing is or where it is out of date."""
    try:
        prepared = read_json(urdf.parent / FILE_NAME, MOST_BYTES)
        return prepared if prepared["sha256"] == _fingerprint(urdf) else None
    except (InputError, OSError, KeyError, TypeError):
        return None


def write_prepared(urdf: Path, model: Mapping[str, Any], shape: Mapping[str, Any]) -> None:
    """Write the JSON of a robot's model and shape beside its URDF."""
    prepared = {"sha256": _fingerprint(urdf), "model": model, "shape": shape}
    text = json.dumps(prepared, indent=1, sort_keys=True) + "\n"
    (urdf.parent / FILE_NAME).write_text(text, encoding="utf-8", newline="\n")


def _fingerprint(urdf: Path) -> str:
    """Return a hash of the URDF and of everything below its folder's `meshes/collision`."""
    whole = hashlib.sha256(urdf.read_bytes())
    for path in sorted((urdf.parent / "meshes" / "collision").glob("*")):
        whole.update(path.name.encode() + hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()
