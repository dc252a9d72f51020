"""The head of a trial as the tip meets it: where it truly lies, its fiducials, its shifted skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.training.true_error import Truth
from rastrainer_simulator.vectors import Vector, vector

if TYPE_CHECKING:
    from rastrainer.head.skin_shift import SkinShift
    from rastrainer.scenario.scenario import Scenario
    from rastrainer.scenario.tasks import Task


@dataclass(frozen=True, eq=False)
class PlacedHead:
    """A head in World.

    Attributes:
        truth: where it truly lies, mm.
        fiducials: label → position in World, m, of a trial's task; empty between trials.
    """

    truth: Truth
    fiducials: Mapping[str, Vector] = field(default_factory=dict)
    _mesh: HeadMesh | None = None

    @classmethod
    def nominal(cls, scenario: Scenario) -> PlacedHead:
        """Return the head between trials, where the scenario puts it."""
        return cls(Truth.of(scenario, scenario.head_to_world))

    @classmethod
    def of_trial(cls, scenario: Scenario, task: Task, seed: int, skin: SkinShift) -> PlacedHead:
        """Return the head of a trial, moved and with its skin shifted by the trial's seed.

        Raises:
            InputError: the skin is shifted, but the scenario's head cannot be read.
        """
        mesh = None if skin.is_none else read_head_mesh(scenario.head_mesh)
        pose = scenario.perturbed_head_to_world(seed)
        truth = Truth.of(scenario, pose, task, skin if skin.is_none else replace(skin, seed=seed))
        places = truth.in_world(np.array(list(truth.fiducials.values()))) / MM_PER_M
        fiducials = dict(zip(truth.fiducials, map(tuple, places.tolist()), strict=True))
        return cls(truth, fiducials, mesh)

    def measured(self, tip: Vector) -> Vector:
        """Return where a tip is measured that the skin has shifted with, World, m."""
        if self._mesh is None:
            return tip
        measured = self.truth.measured(MM_PER_M * np.array(tip), self._mesh)
        return vector((measured / MM_PER_M).tolist())
