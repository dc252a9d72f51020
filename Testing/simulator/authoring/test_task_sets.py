"""Sets of tasks for an unknown head: proposals and refusals."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, outward_normals, read_head_mesh
from rastrainer.scenario.points import LABELS, PlannedTarget, PlannedTrajectory, read_fiducials
from rastrainer.scenario.scenario import SkullKind
from rastrainer.scenario.writer import HeadDraft
from rastrainer_simulator.authoring import scenario_check, task_proposal
from rastrainer_simulator.authoring.face_removal import face_vertices
from rastrainer_simulator.authoring.make import ScenarioOptions, make_scenario, without_tasks
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.scenario_check import check_plan, check_tasks
from rastrainer_simulator.authoring.task_proposal import propose_tasks
from Testing.simulator.authoring.heads import HEADS, egg

SEED = 5
NAMES = ["trial-run", "task-1", "task-2", "task-3", "task-4", "task-5"]


WISHES = ScenarioOptions(
    "An egg",
    "made up",
    "none needed",
    targets=(PlannedTarget("Tumor", np.array([15.0, 10.0, 30.0])),),
    trajectory=PlannedTrajectory("Biopsy", np.array([10.0, 20.0, 97.0]), np.array([15.0, 10, 30])),
)


@pytest.fixture(scope="module")
def planning():
    head = egg()
    return PlanningSetup(without_tasks(HeadDraft(head, "made up"), WISHES), head)


@pytest.fixture(scope="module")
def tasks(planning):
    """A set that is touchable in a few poses."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(task_proposal, "WIDE_SEEDS", range(1000, 1002))
        patch.setattr(task_proposal, "TRIAL_SEEDS", range(2000, 2001))
        return propose_tasks(planning, SEED)


def test_there_are_six_tasks_of_rising_complexity_on_the_skin_off_the_face(planning, tasks):
    assert [task.name for task in tasks] == NAMES
    assert all(harder.complexity > 1.05 * easier.complexity for easier, harder in pairwise(tasks))
    fiducials = np.concatenate([task.fiducials for task in tasks])
    assert max(nearest_on_mesh(planning.mesh, point).distance for point in fiducials) < 0.05
    face = planning.mesh.vertices[face_vertices(planning.mesh)]
    assert len(face) > 100
    assert np.linalg.norm(fiducials[:, None] - face[None], axis=2).min() > 5.0


@pytest.mark.soak
@pytest.mark.parametrize("name", HEADS)
def test_proposed_sets_pass_the_check_and_can_be_touched_in_999_of_1000_other_trials(name):
    head = HEADS[name]()
    draft, options = HeadDraft(head, "test"), ScenarioOptions(name, "test", "none")
    planning = PlanningSetup(without_tasks(draft, options), head)
    others, can_be = planning.poses(range(60_000, 60_012))[1:], []
    for seed in range(100, 110):
        tasks = propose_tasks(planning, seed)
        assert check_tasks(planning, tasks) == [], seed
        for task in tasks:
            touched = task.fiducials, outward_normals(head, task.fiducials)
            can_be += [planning.touchable(*touched, [pose]).all() for pose in others]
    assert np.mean(can_be) >= 0.999


def moved(task, index, point):
    fiducials = task.fiducials.copy()
    fiducials[index] = point
    return replace(task, fiducials=fiducials)


def test_each_problem_of_a_task_is_reported_in_its_own_sentence(planning, tasks, monkeypatch):
    monkeypatch.setattr(scenario_check, "POSES_TRIED", 1)
    run, first = tasks[:2]
    lifted = moved(run, 2, run.fiducials[2] * 1.1)
    assert "Trial run: fiducial 3 is" in check_tasks(planning, [lifted])[0]
    near = nearest_on_mesh(planning.mesh, run.fiducials[4] + [6.0, 0.0, 0.0]).position
    assert "fiducials 5 and 7 are" in check_tasks(planning, [moved(run, 6, near)])[0]
    low = nearest_on_mesh(planning.mesh, np.array([0.0, -30.0, -75.0])).position
    assert "cannot touch fiducial 9 where the head is" in " ".join(
        check_tasks(planning, [moved(run, 8, low)])
    )
    assert "must be above" in check_tasks(planning, [first, run])[-1]
    assert "its complexity is" in check_tasks(planning, [replace(run, complexity=3.0)])[0]
    unmeasured, wrong = (replace(run, shortest_path_mm=stated) for stated in (None, 5.0))
    assert "shortestPathMm says none" in check_tasks(planning, [unmeasured])[0]
    assert "shortestPathMm says 5.0 mm" in check_tasks(planning, [wrong])[0]


def test_a_plan_outside_the_head_or_out_of_reach_is_reported(planning):
    outside = (PlannedTarget("Elsewhere", np.array([300.0, 0.0, 0.0])),)
    scenario = replace(planning.scenario, targets=outside)
    assert "Elsewhere is" in check_plan(PlanningSetup(scenario, planning.mesh))[0]
    below = PlannedTrajectory("From below", np.array([0.0, 0.0, -75.0]), np.array([0.0, 0, 20]))
    scenario = replace(planning.scenario, trajectory=below)
    assert "From below" in check_plan(PlanningSetup(scenario, planning.mesh))[0]


def test_a_first_target_too_deep_to_start_above_becomes_an_additional_one_and_that_is_reported():
    deep = PlannedTarget("Brainstem", np.array([0.0, -10.0, -60.0]))
    warnings = []
    wishes = replace(WISHES, targets=(deep, *WISHES.targets))
    scenario = without_tasks(HeadDraft(egg(), "made up"), wishes, warnings.append)
    assert scenario.target.name == "Center of the head"
    assert [target.name for target in scenario.targets] == ["Brainstem", "Tumor"]
    (sentence,) = warnings
    assert sentence.startswith("Brainstem is too deep for trials to start above it")
    assert "reported at Center of the head" in sentence


@pytest.fixture
def placed(tmp_path, tasks):
    """Options with fiducials that are placed by hand."""
    path = tmp_path / "mine.mrk.json"
    write_markups(path, PointList(LABELS, tasks[0].fiducials))
    return replace(WISHES, task_files=(path,))


@pytest.mark.usefixtures("unrendered")
def test_hand_placed_fiducials_become_tasks_and_a_skull_made_meanwhile_is_included(
    tmp_path, tasks, placed
):
    skull = HeadMesh(0.9 * egg().vertices, egg().triangles)
    first, whole = (
        HeadDraft(egg(), "made up"),
        HeadDraft(egg(), "with skull", skull, SkullKind.APPROXIMATION),
    )
    scenario = make_scenario(first, placed, tmp_path / "egg", wait_for_skull=lambda: whole)
    assert scenario.provenance.method == "with skull"
    assert scenario.skull.kind is SkullKind.APPROXIMATION
    assert len(read_head_mesh(scenario.skull.file).triangles) == len(skull.triangles)
    assert [task.title for task in scenario.tasks] == ["Trial run"]
    assert scenario.tasks[0].complexity == pytest.approx(tasks[0].complexity, abs=0.02)
    assert scenario.preview is not None
    again = read_fiducials(placed.task_files[0])
    assert np.array_equal(scenario.tasks[0].fiducials, again)


def test_a_trajectory_enters_through_the_skin(planning):
    def wrong(height):
        entry = np.array([10.0, 20.0, height])
        trajectory = replace(WISHES.trajectory, entry_ras=entry)
        scenario = replace(planning.scenario, trajectory=trajectory)
        return "".join(check_plan(PlanningSetup(scenario, planning.mesh)))

    assert "enters 35 mm below the skin, within the head" in wrong(60.0)
    assert "enters 27 mm above the skin" in wrong(125.0)
    assert wrong(90.0) == ""
