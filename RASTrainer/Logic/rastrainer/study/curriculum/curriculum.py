"""A curriculum and its file: assignments, each with a goal, and which come before it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from rastrainer.errors import InputError
from rastrainer.json_checks import identifier, list_of, text
from rastrainer.json_records import record_to_json
from rastrainer.protocol import MAX_ASSIGNMENTS
from rastrainer.study.protocol.plan_file import plan_from_json, read_plan
from rastrainer.study_messages import Assignment

_VERSIONS = {"formatVersion": 1}


@dataclass(frozen=True)
class Curriculum:
    """What a trainee should reach."""

    name: Annotated[str, identifier]
    title: Annotated[str, text(80)]
    assignments: Annotated[tuple[Assignment, ...], list_of(1, MAX_ASSIGNMENTS, "objects")]

    def __post_init__(self) -> None:
        earlier: set[str] = set()
        for each in self.assignments:
            what = f"The curriculum {self.name}: assignment {each.name}"
            if each.name in earlier:
                raise InputError(f"{what}: name must be one that no other assignment has.")
            if not set(each.after) <= earlier:
                raise InputError(
                    f"{what}: after must be a list of assignments that stand before this one."
                )
            earlier.add(each.name)

    def to_json(self) -> dict[str, Any]:
        """Return the object that the file holds."""
        return {**_VERSIONS, **record_to_json(self)}


def read_curriculum(path: Path | str) -> Curriculum:
    return read_plan(Curriculum, path, _VERSIONS)


def curriculum_from_json(value: Any) -> Curriculum:
    return plan_from_json(Curriculum, value, _VERSIONS, "The curriculum")
