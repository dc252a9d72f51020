"""Pack a scenario for others, without what tells whose head it is unless that is wanted."""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.head.face_removal import without_face
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.head.surface_queries import nearest_on_mesh
from rastrainer.head.volume import read_head_volume
from rastrainer.scenario.package import checked_scenario, pack
from rastrainer.scenario.scenario import PREVIEW_NAME, Scenario
from rastrainer.scenario.writer import scenario_name, write_scenario
from rastrainer_simulator.authoring.faceless_volume import without_face_in
from rastrainer_simulator.authoring.preview import draw_preview
from rastrainer_simulator.authoring.task_check import ON_SKIN_MM

FACELESS = " The face was taken off."
NO_SOURCE = "Taken off before the scenario was given on."


def pack_for_others(
    folder: Path, package: Path, keeps_face: bool = False, keeps_names: bool = False
) -> str:
    """Write a scenario as one zip file and return a sentence that says what was taken off.

    Args:
        folder: of the scenario, which stays as it is.
        package: the new file.
        keeps_face: leave the head, its picture, its images and its skull as they are; else head,
            picture and images have no face, and no skull is given on.
        keeps_names: leave title, name and source, which often are the patient's name, as they
            are; else the scenario is called by a number that is made of its head's surface.

    Raises:
        InputError: the scenario cannot be used, or has fiducials on the face.
    """
    scenario, taken = checked_scenario(folder), []
    head = read_head_mesh(scenario.head_mesh)
    skull = read_head_mesh(scenario.skull_mesh) if scenario.skull_mesh else None
    volume = read_head_volume(scenario.volume) if scenario.volume else None
    preview = scenario.preview
    if not keeps_face:
        volume = without_face_in(volume, head) if volume else None
        scenario, head, skull = *_faceless(scenario, head), None
        taken += ["the face", "the skull"] if scenario.skull_mesh else ["the face"]
    if not keeps_names:
        scenario = _nameless(scenario, head)
        taken += ["its title", "its name", "its source"]
    with tempfile.TemporaryDirectory() as temporary:
        clean = Path(temporary)
        write_scenario(clean, scenario, head, skull, volume)
        if not keeps_face:
            draw_preview(clean / PREVIEW_NAME, scenario, head)
        elif preview:
            shutil.copyfile(preview, clean / PREVIEW_NAME)
        pack(clean, package)
    if not taken:
        return "Nothing was taken off."
    return f"Taken off: {', '.join(taken)}. It is called {scenario.title} now."


def _faceless(scenario: Scenario, head: HeadMesh) -> tuple[Scenario, HeadMesh]:
    head = without_face(head)
    for task in scenario.tasks:
        away = [nearest_on_mesh(head, point).distance for point in task.fiducials]
        lost = [label for label, d in zip(task.labels, away, strict=True) if d > ON_SKIN_MM]
        if lost:
            raise InputError(
                f"{task.title} has fiducials on the face ({', '.join(lost)}), which would be taken "
                "off; move them, or keep the face."
            )
    provenance = scenario.provenance
    if not provenance.method.endswith(FACELESS):
        provenance = replace(provenance, method=provenance.method + FACELESS)
    return replace(scenario, provenance=provenance), head


def _nameless(scenario: Scenario, head: HeadMesh) -> Scenario:
    number = hashlib.sha256(head.vertices.astype("<f4").tobytes()).hexdigest()[:6]
    title = f"Head {number}"
    provenance = replace(scenario.provenance, source=NO_SOURCE)
    return replace(scenario, name=scenario_name(title), title=title, provenance=provenance)
