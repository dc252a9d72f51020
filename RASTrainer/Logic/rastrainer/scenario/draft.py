"""A head that is to become a scenario: what Slicer's side hands to the planner of tasks.

A folder with `draft.json`, `head.ply` and, where there are, `skull.ply` and `volume.nrrd`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.files.json_fields import read_fields
from rastrainer.files.writing import write_text
from rastrainer.head.mesh import HeadMesh, read_head_mesh, write_head_mesh
from rastrainer.head.volume import HeadVolume, read_head_volume, read_volume_file, write_head_volume
from rastrainer.scenario.scenario import SKULL_KINDS
from rastrainer.scenario.writer import HEAD_NAME, SKULL_NAME, VOLUME_NAME, volume_entry

FILE_NAME = "draft.json"
NO_SKULL = "none"


@dataclass(frozen=True)
class HeadDraft:
    """A head and how it was made.

    Attributes:
        head: closed, with a flat base, RAS mm.
        method: how it was made, for the scenario's provenance.
        skull: None where there is none.
        is_skull_approximate: whether the skull is only the skin moved inward.
        volume: the images it was made of; None where they are not wanted.
    """

    head: HeadMesh
    method: str
    skull: HeadMesh | None = None
    is_skull_approximate: bool = False
    volume: HeadVolume | None = None


def write_draft(folder: Path, draft: HeadDraft) -> None:
    """Write a draft into a folder that exists.

    Raises:
        InputError: a file cannot be written.
    """
    kind = SKULL_KINDS[int(draft.is_skull_approximate)] if draft.skull else NO_SKULL
    write_head_mesh(folder / HEAD_NAME, draft.head)
    if draft.skull is not None:
        write_head_mesh(folder / SKULL_NAME, draft.skull)
    content: dict[str, Any] = {"method": draft.method, "skull": kind}
    if draft.volume is not None:
        write_head_volume(folder / VOLUME_NAME, draft.volume)
        content["volume"] = volume_entry(draft.volume)
    write_text(folder / FILE_NAME, json.dumps(content, indent=2, ensure_ascii=False) + "\n")


def read_draft(folder: Path) -> HeadDraft:
    """Read a draft.

    Raises:
        InputError: it is missing or cannot be used.
    """
    fields = read_fields(folder / FILE_NAME)
    kind = fields.one_of("skull", (*SKULL_KINDS, NO_SKULL))
    volume = read_volume_file(fields)
    return HeadDraft(
        read_head_mesh(folder / HEAD_NAME),
        fields.text("method", 4000),
        None if kind == NO_SKULL else read_head_mesh(folder / SKULL_NAME),
        kind == SKULL_KINDS[1],
        None if volume is None else read_head_volume(volume),
    )
