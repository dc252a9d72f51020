"""A hundred sets of tasks on three heads: each keeps its promises with every seed."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial import cKDTree

from rastrainer import transforms
from rastrainer.head.mesh import nearest_on_mesh, outward_normals
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.writer import HeadDraft
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.make import ScenarioOptions, without_tasks
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.task_set import TaskSetProposer
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.scene.skin_marks import skin_marks
from Testing.simulator.authoring.heads import HEADS

SETS = {"egg": range(34), "colin27": range(100, 133), "deformed": range(200, 233)}
ON_SKIN_MM = 0.05
APART_MM = 0.3
OTHER_POSES = range(60_000, 60_003)
SAMPLE = 9
"""Every n-th fiducial is touched in the collision model of a simulation."""
CLEARANCE_M, AT_PLACE_M = 0.005, 1e-4


@pytest.mark.soak
@pytest.mark.parametrize("name", HEADS)
def test_a_hundred_task_sets_keep_all_promises(name):
    head = HEADS[name]()
    planning = PlanningSetup(
        without_tasks(HeadDraft(head, "test"), ScenarioOptions(name, "test", "none")), head
    )
    proposer = TaskSetProposer(planning)
    for seed in SETS[name]:
        broken = broken_promises(planning, proposer.propose(seed))
        print(f"{name}, seed {seed}: {broken or 'all kept'}", flush=True)
        assert not broken, (name, seed)


def broken_promises(planning, tasks):
    """Return the faults of a set, in words."""
    broken = []
    if len(tasks) != 6 or not all(b.complexity > a.complexity for a, b in pairwise(tasks)):
        broken.append("the complexity does not rise")
    fiducials = np.concatenate([task.fiducials for task in tasks])
    if max(nearest_on_mesh(planning.mesh, point).distance for point in fiducials) > ON_SKIN_MM:
        broken.append("a fiducial is off the skin")
    unique = np.unique(fiducials, axis=0)
    normals = outward_normals(planning.mesh, unique)
    # The nominal pose, and poses that the proposal has not tried.
    if not planning.touchable(unique, normals, planning.poses(OTHER_POSES)).all():
        broken.append("a fiducial cannot be touched with 5 mm clearance")
    poses = planning.poses(OTHER_POSES[:1])
    broken += [f"{place} is crowded" for place in crowded(planning, unique[::SAMPLE], poses)]
    return broken + [
        f"{task.name}: {label} overlaps" for task in tasks for label in hidden(task, planning)
    ]


def crowded(planning, places, poses):
    """Return the points at whose touch something other than the tip is within 5 mm, or the tip off.

    The planner's posture is judged by a separate collision model, as a simulation makes it.
    """
    collision = head_collision(planning.setup.shape, planning.mesh, planning.scenario)
    kinematics = make_kinematics(planning.setup.robot)
    planner = TouchPlanner(planning.setup.robot, planning.collision)
    found = []
    for pose in poses:
        head_to_world = np.array(pose)
        head_to_world[:3, 3] /= MM_PER_M
        for each in (collision, planning.collision):
            each.set_head_pose(head_to_world)
        for place in places:
            position = transforms.apply(head_to_world, place / MM_PER_M)
            normal = head_to_world[:3, :3] @ outward_normals(planning.mesh, [place])[0]
            touch = planner.touch(position, normal)
            near = collision.check(kinematics.links(touch.q))
            least = min(near.links_m, near.self_m, near.table_m)
            away = np.linalg.norm(kinematics.tip(touch.q)[:3, 3] - position)
            if least < CLEARANCE_M or near.shaft_m <= 0.0 or away > AT_PLACE_M:
                found.append(place)
    return found


def hidden(task, planning):
    """Return the labels whose number overlaps an arrow, a dot or another number.

    Also those whose arrow overlaps another arrow, or a dot that it does not join.
    """
    marks = skin_marks(planning.mesh, task.fiducials, LABELS)
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
    return overlapping + [mark.label for row, mark in enumerate(marks) if meets(marks, row)]


def meets(marks, row):
    """Return whether a mark's arrow meets another arrow, or a dot that it does not join."""
    if marks[row].arrow is None:
        return False
    others = [mark.arrow.points for mark in marks[row + 1 :] if mark.arrow]
    others += [mark.rim.points for each, mark in enumerate(marks) if each not in (row, row + 1)]
    tree = cKDTree(np.concatenate(others))
    return tree.query(marks[row].arrow.points)[0].min() <= APART_MM
