"""What lies ahead of the guide: where its axis truly enters the head and its skull."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.checks import planned_bone
from rastrainer.procedure.geometry import BoneAhead, bone_ahead, mesh_crossings
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.procedure_state import GuideAxis
from rastrainer_simulator.training.feed import LONGEST_FEED_M, HeadAhead

BEHIND_MM = 1.0
"""A tip that rests on the skin may be a little within it: the search begins so far behind it."""


PlannedBone = Mapping[str, tuple[BoneAhead | None, ...]]
"""Where the planned lines of each procedure go through bone, mm from the entry."""


class TrueHead:
    """The surfaces of skin and skull of a scenario with procedures.

    Attributes:
        planned_bone: on the lines of each procedure, in their order.
    """

    def __init__(self, scenario: Scenario, skin: HeadMesh) -> None:
        """Read the skull of the scenario whose skin is given.

        Raises:
            InputError: its mesh cannot be used.
        """
        assert scenario.skull_mesh is not None, "a scenario with procedures has a skull"
        self._skin, self._skull = skin, read_head_mesh(scenario.skull_mesh)
        # Computed now, not in the tick in which the first guide is locked.
        _ = skin.triangle_spheres, self._skull.triangle_spheres
        self.planned_bone: PlannedBone = {
            each.name: tuple(planned_bone(line, self._skull) for line in each.trajectories)
            for each in scenario.procedures
        }

    def ahead(self, guide: GuideAxis, head_to_world: np.ndarray) -> HeadAhead:
        """Return what lies ahead along a guide's axis, with the head at (4, 4) float, m."""
        rotation, shift = head_to_world[:3, :3], head_to_world[:3, 3]
        axis = rotation.T @ np.array(guide.direction)
        tip_mm = MM_PER_M * (rotation.T @ (np.array(guide.tip) - shift))
        line = tip_mm - BEHIND_MM * axis, axis, MM_PER_M * LONGEST_FEED_M + BEHIND_MM
        crossings = mesh_crossings(self._skin, *line)
        bone = bone_ahead(self._skull, *line)
        return HeadAhead(
            skin=_from_tip(crossings[0].distance_mm) if crossings else None,
            outer=None if bone is None else _from_tip(bone.outer_mm),
            inner=None if bone is None or bone.inner_mm is None else _from_tip(bone.inner_mm),
        )


def _from_tip(distance_mm: float) -> float:
    return max(0.0, distance_mm - BEHIND_MM) / MM_PER_M
