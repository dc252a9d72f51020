"""A hundred sets of tasks on three heads: what is promised of each holds for every seed."""

from itertools import pairwise

import numpy as np
import pytest

from rastrainer.scenario_draft import HeadDraft
from rastrainer.surface_queries import nearest_on_mesh, outward_normal
from rastrainer.tasks import LABELS
from rastrainer_simulator.planning.task_set import TaskSetProposer
from rastrainer_simulator.planning.workbench import Workbench
from rastrainer_simulator.scenarios.make import Wishes, without_tasks
from rastrainer_simulator.scene.skin_marks import skin_marks
from Testing.simulator.scenarios.heads import HEADS

SETS = {"egg": range(34), "colin27": range(100, 133), "deformed": range(200, 233)}
ON_SKIN_MM = 0.05
APART_MM = 0.3
OTHER_POSES = range(60_000, 60_003)


@pytest.mark.soak
@pytest.mark.parametrize("name", HEADS)
def test_a_hundred_sets_keep_what_is_promised(name):
    head = HEADS[name]()
    bench = Workbench(without_tasks(HeadDraft(head, "test"), Wishes(name, "test", "none")), head)
    proposer = TaskSetProposer(bench)
    for seed in SETS[name]:
        broken = broken_promises(bench, proposer.propose(seed))
        print(f"{name}, seed {seed}: {broken or 'all kept'}", flush=True)
        assert not broken, (name, seed)


def broken_promises(bench, tasks):
    """Return what is wrong with a set, in words."""
    broken = []
    if len(tasks) != 6 or not all(b.complexity > a.complexity for a, b in pairwise(tasks)):
        broken.append("the complexity does not rise")
    fiducials = np.concatenate([task.fiducials for task in tasks])
    if max(nearest_on_mesh(bench.mesh, point).distance for point in fiducials) > ON_SKIN_MM:
        broken.append("a fiducial is off the skin")
    unique = np.unique(fiducials, axis=0)
    normals = np.array([outward_normal(bench.mesh, point) for point in unique])
    # The nominal pose, and poses that the proposal has not tried.
    if not bench.touchable(unique, normals, bench.poses(OTHER_POSES)).all():
        broken.append("a fiducial cannot be touched with 5 mm clearance")
    return broken + [
        f"{task.name}: {label} overlaps" for task in tasks for label in hidden(task, bench)
    ]


def hidden(task, bench):
    """Return the labels whose number overlaps an arrow, a dot or another number."""
    marks = skin_marks(bench.mesh, task.fiducials, LABELS)
    shapes = [mark.arrow.points for mark in marks if mark.arrow] + [
        mark.rim.points for mark in marks
    ]
    overlapping = []
    for index, mark in enumerate(marks):
        others = [other.number.points for row, other in enumerate(marks) if row != index]
        around = np.concatenate([*shapes, *others])
        away = np.linalg.norm(mark.number.points[:, None] - around[None], axis=2)
        if away.min() <= APART_MM:
            overlapping.append(mark.label)
    return overlapping
