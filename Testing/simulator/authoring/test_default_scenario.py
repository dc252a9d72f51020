"""The promises of the default scenario: a sound head, and tasks on it that the robot can do."""

import json
from itertools import pairwise

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.registration.localization_error import LocalizationError
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import expected_tre
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.task_proposal import target_spread
from rastrainer_simulator.authoring.touch_order import SurfaceGraph, complexity

FOLDER = asset_path("scenarios", "colin27")
SCENARIO = load_scenario(FOLDER)
MESH = read_head_mesh(SCENARIO.head)
GRAPH = SurfaceGraph(MESH)
TASK_NAMES = ["trial-run", "task-1", "task-2", "task-3", "task-4", "task-5"]


@pytest.fixture(scope="module")
def computed():
    """The complexity of each task, computed again."""
    eye = transforms.apply(
        transforms.inverse(SCENARIO.head_to_world), SCENARIO.cameras["close-up"].position_mm
    )
    return [complexity(task.fiducials, GRAPH, eye) for task in SCENARIO.tasks]


def test_the_head_is_one_closed_body_without_tunnels():
    assert MESH.is_closed
    assert MESH.euler_characteristic == 2
    assert 40_000 <= len(MESH.triangles) <= 60_000


def test_the_head_is_upright_with_its_face_to_the_camera_and_its_right_to_the_robot():
    turn = SCENARIO.head_to_world[:3, :3]
    assert np.allclose(turn @ [0, 0, 1], [0, 0, 1])
    assert np.allclose(turn @ [0, 1, 0], [0, -1, 0])
    assert np.allclose(turn @ [1, 0, 0], [-1, 0, 0])
    base = transforms.apply(SCENARIO.head_to_world, MESH.vertices)[:, 2].min()
    assert base > 100
    assert np.allclose(SCENARIO.target.position_ras, MESH.centroid, atol=1e-3)


def test_complexity_rises_from_task_to_task_and_matches_the_files(computed):
    indices = [parts.index for parts in computed]
    assert all(harder > 1.05 * easier for easier, harder in pairwise(indices))
    assert [task.complexity for task in SCENARIO.tasks] == pytest.approx(indices, abs=0.01)


def test_the_readme_has_the_same_numbers(computed):
    readme = (FOLDER.parent / "README.md").read_text(encoding="utf-8")
    for task, parts in zip(SCENARIO.tasks, computed, strict=True):
        row = (
            f"| {task.title} | {parts.path_length_mm:.0f} | {parts.turning_deg:.0f} | "
            f"{parts.hidden_points} | {parts.reorientation_deg:.0f} | {parts.index:.2f} |"
        )
        assert row in readme


def test_the_first_tasks_are_all_in_view_and_the_last_goes_around_the_head(computed):
    assert [parts.hidden_points for parts in computed[:2]] == [0, 0]
    assert computed[-1].hidden_points >= 8
    last = SCENARIO.task("task-5").fiducials
    changes = np.count_nonzero(np.diff(np.sign(last[:, 0])))
    assert changes >= 8


@pytest.mark.parametrize("name", TASK_NAMES)
def test_the_fiducials_locate_the_center_of_the_head_well(name):
    fiducials = SCENARIO.task(name).fiducials
    same = register(fiducials, fiducials)
    unit = LocalizationError(np.tile(np.eye(3), (len(fiducials), 1, 1)), np.inf)
    expected_mm = expected_tre(
        same, SCENARIO.target.position_ras[None], unit, common_bias_sd_mm=0.0
    )
    ratio = expected_mm[0] / np.sqrt(3)
    assert ratio < (0.7 if name == "trial-run" else 0.4)
    assert target_spread(fiducials, SCENARIO.target.position_ras) == pytest.approx(ratio**2)


@pytest.mark.parametrize("count", [1, pytest.param(20, marks=pytest.mark.soak)])
def test_the_robot_can_touch_every_fiducial_in_other_poses_of_the_head(count):
    planning = PlanningSetup(SCENARIO, MESH)
    fiducials = np.concatenate([task.fiducials for task in SCENARIO.tasks])
    normals = outward_normals(MESH, fiducials)
    seeds = range(90_000, 90_000 + count)
    poses = [SCENARIO.head_to_world, *map(SCENARIO.perturbed_head_to_world, seeds)]
    assert planning.touchable(fiducials, normals, poses).all()
    far = SCENARIO.head_to_world.copy()
    far[:3, 3] += [1000.0, 0.0, 0.0]
    assert not planning.touchable(fiducials[:2], normals[:2], [poses[0], far]).any()


def test_the_notice_of_the_mri_travels_with_the_scenario():
    content = json.loads((FOLDER / "scenario.json").read_text(encoding="utf-8"))
    assert "Louis Collins, McConnell Brain Imaging Centre" in content["provenance"]["license"]
