"""Files that people write of a study's plan: a protocol, a curriculum."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from rastrainer.errors import InputError
from rastrainer.files.reading import MAX_RECORD_BYTES, read_json
from rastrainer.json_records import record_from_json, record_to_json

T = TypeVar("T", bound="PlanFile")


class PlanFile:
    """A record whose file also states the versions that this program reads, by their keys."""

    WHAT: ClassVar[str]
    VERSIONS: ClassVar[Mapping[str, Any]]

    @classmethod
    def read(cls: type[T], path: Path | str) -> T:
        return cls.from_json(read_json(Path(path), MAX_RECORD_BYTES), str(path))

    @classmethod
    def from_json(cls: type[T], value: object, what: str = "") -> T:
        """Return the record of a decoded JSON object; `what` it is begins the errors."""
        what = what or cls.WHAT
        if not isinstance(value, dict):
            raise InputError(f"{what} must hold one JSON object.")
        for key, version in cls.VERSIONS.items():
            if value.get(key) != version:
                raise InputError(f"{what}: {key} must be {version}, which this version reads.")
        others = {key: item for key, item in value.items() if key not in cls.VERSIONS}
        return record_from_json(cls, others, what, only_known=True)

    def to_json(self) -> dict[str, Any]:
        return {**self.VERSIONS, **record_to_json(self)}
