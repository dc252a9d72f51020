"""Files that people write of a study's plan: a protocol, a curriculum."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from rastrainer.errors import InputError
from rastrainer.files.reading import MAX_RECORD_BYTES, read_json
from rastrainer.json_records import record_from_json

T = TypeVar("T")


def read_plan(kind: type[T], path: Path | str, versions: Mapping[str, Any]) -> T:
    return plan_from_json(kind, read_json(Path(path), MAX_RECORD_BYTES), versions, str(path))


def plan_from_json(kind: type[T], value: object, versions: Mapping[str, Any], what: str) -> T:
    """Return the record of a decoded JSON object that states these versions, by their keys."""
    if not isinstance(value, dict):
        raise InputError(f"{what} must hold one JSON object.")
    for key, version in versions.items():
        if value.get(key) != version:
            raise InputError(f"{what}: {key} must be {version}, which this version reads.")
    others = {key: item for key, item in value.items() if key not in versions}
    return record_from_json(kind, others, what, only_known=True)
