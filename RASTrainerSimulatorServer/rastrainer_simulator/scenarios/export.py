"""Pack a scenario for others, without the patient's face unless it is wanted."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.face_removal import without_face
from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import PREVIEW_NAME
from rastrainer.scenario_package import checked_scenario, pack
from rastrainer.scenario_writer import write_scenario
from rastrainer.surface_queries import nearest_on_mesh
from rastrainer_simulator.planning.task_check import ON_SKIN_MM
from rastrainer_simulator.scenarios.picture import draw_preview

FACELESS = " The face was taken off."


def pack_without_face(folder: Path, package: Path) -> Path:
    """Write a scenario as one zip file in which head and picture have no face, and no skull is.

    Raises:
        InputError: the scenario cannot be used, or has fiducials on the face.
    """
    scenario = checked_scenario(folder)
    head = without_face(read_head_mesh(scenario.head_mesh))
    for task in scenario.tasks:
        away = [nearest_on_mesh(head, point).distance for point in task.fiducials]
        lost = [label for label, d in zip(task.labels, away, strict=True) if d > ON_SKIN_MM]
        if lost:
            raise InputError(
                f"{task.title} has fiducials on the face ({', '.join(lost)}), which would be taken "
                "off; move them, or pack with --keep-face."
            )
    provenance = scenario.provenance
    if not provenance.method.endswith(FACELESS):
        provenance = replace(provenance, method=provenance.method + FACELESS)
    scenario = replace(scenario, provenance=provenance, skull_mesh=None)
    with tempfile.TemporaryDirectory() as temporary:
        clean = Path(temporary)
        write_scenario(clean, scenario, head)
        draw_preview(clean / PREVIEW_NAME, scenario, head)
        return pack(clean, package)
